//! Products that share two factors: the pair becomes a product of its own, which is then computed once.

use super::Node;
use rustc_hash::FxHashMap as HashMap;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Most pairs pulled out of one kernel: a bound on the work, far above what joints need.
const MOST_PAIRS: usize = 400;

/// Pulls the most frequent pairs of factors out of all products of the formulas.
pub fn extract_pairs(formulas: &mut [Node]) {
    let mut search = Search::new(formulas);
    if search.most_frequent().is_none() {
        return;
    }
    for _ in 0..MOST_PAIRS {
        let Some(pair) = search.most_frequent() else {
            break;
        };
        search.pull_out(pair);
    }
    let mut done = HashMap::default();
    for formula in formulas {
        search.rewrite(formula, &mut done);
    }
}

/// Two factors by number.
type Pair = (usize, usize);

/// A factor of products.
enum Factor {
    /// A formula as it stood.
    Formula(Node),
    /// Two factors pulled out together.
    Pair(Pair),
}

/// The products that hold a pair.
#[derive(Default)]
struct Uses {
    all: BTreeSet<usize>,
    /// How many of them have further factors.
    long: usize,
}

impl Uses {
    /// Their number, where the pair is worth a product of its own: in two at least, one of them longer than the pair.
    fn worth(&self) -> Option<usize> {
        (self.all.len() >= 2 && self.long >= 1).then_some(self.all.len())
    }
}

/// The distinct products of the formulas, as lists of numbered factors.
struct Search {
    factors: Vec<Factor>,
    products: Vec<Vec<usize>>,
    by_value: BTreeMap<Vec<Node>, usize>,
    uses: HashMap<Pair, Uses>,
    /// The pairs that are worth it, by the number of their products.
    frequent: BTreeSet<(Reverse<usize>, Pair)>,
}

impl Search {
    fn new(formulas: &[Node]) -> Self {
        let mut search = Self {
            factors: vec![],
            products: vec![],
            by_value: BTreeMap::new(),
            uses: HashMap::default(),
            frequent: BTreeSet::new(),
        };
        let mut distinct: BTreeSet<Vec<Node>> = BTreeSet::new();
        for formula in formulas {
            formula.visit(&mut |node| {
                if let Node::Product(factors) = node
                    && !distinct.contains(factors)
                {
                    distinct.insert(factors.clone());
                }
            });
        }
        let numbers = search.number(distinct.iter().flatten());
        let list = |product: &Vec<Node>| product.iter().map(|factor| numbers[factor]).collect();
        search.products = distinct.iter().map(list).collect();
        search.by_value = distinct.into_iter().zip(0..).collect();
        (0..search.products.len()).for_each(|product| search.count(product, true));
        search
    }

    /// Numbers the factors in ascending order.
    fn number<'a>(&mut self, factors: impl Iterator<Item = &'a Node>) -> HashMap<&'a Node, usize> {
        let distinct: BTreeSet<&Node> = factors.collect();
        let formulas = distinct.iter().copied().cloned();
        self.factors.extend(formulas.map(Factor::Formula));
        distinct.into_iter().zip(0..).collect()
    }

    /// Adds the pairs of a product to the uses, or takes them away.
    fn count(&mut self, product: usize, add: bool) {
        let factors = &self.products[product];
        let long = usize::from(factors.len() > 2);
        let named =
            |factor: &&usize| !matches!(&self.factors[**factor], Factor::Formula(Node::Number(_)));
        let named: Vec<usize> = factors.iter().filter(named).copied().collect();
        let mut pairs = BTreeSet::new();
        for (i, a) in named.iter().enumerate() {
            pairs.extend(named[i + 1..].iter().map(|b| (*a, *b)));
        }
        for pair in pairs {
            let uses = self.uses.entry(pair).or_default();
            let before = uses.worth();
            match add {
                true => {
                    uses.all.insert(product);
                    uses.long += long;
                }
                false => {
                    uses.all.remove(&product);
                    uses.long -= long;
                }
            }
            let after = uses.worth();
            if before != after {
                before.map(|count| self.frequent.remove(&(Reverse(count), pair)));
                after.map(|count| self.frequent.insert((Reverse(count), pair)));
            }
        }
    }

    /// The pair of factors, numbers aside, in most products.
    fn most_frequent(&self) -> Option<Pair> {
        self.frequent.first().map(|(_, pair)| *pair)
    }

    /// Makes the pair one factor wherever there are others beside it.
    fn pull_out(&mut self, pair: Pair) {
        self.factors.push(Factor::Pair(pair));
        let new = self.factors.len() - 1;
        let holders = self.uses.get(&pair).map(|uses| uses.all.clone());
        for product in holders.unwrap_or_default() {
            if let Some(shorter) = without(&self.products[product], pair, new) {
                self.count(product, false);
                self.products[product] = shorter;
                self.count(product, true);
            }
        }
    }

    /// Makes pairs in the formula products of their own.
    fn rewrite(&self, node: &mut Node, done: &mut HashMap<usize, Node>) {
        let product = match node {
            Node::Product(factors) => self.by_value.get(factors).copied(),
            _ => None,
        };
        let Some(product) = product.filter(|product| self.holds_pair(*product)) else {
            node.change_parts(&mut |part| self.rewrite(part, done));
            return;
        };
        if let Some(known) = done.get(&product) {
            *node = known.clone();
            return;
        }
        let factors = self.products[product].iter();
        *node = Node::Product(factors.map(|factor| self.factor(*factor, done)).collect());
        done.insert(product, node.clone());
    }

    fn holds_pair(&self, product: usize) -> bool {
        let mut factors = self.products[product].iter();
        factors.any(|factor| matches!(self.factors[*factor], Factor::Pair(_)))
    }

    fn factor(&self, factor: usize, done: &mut HashMap<usize, Node>) -> Node {
        match &self.factors[factor] {
            Factor::Formula(node) => {
                let mut node = node.clone();
                self.rewrite(&mut node, done);
                node
            }
            Factor::Pair((a, b)) => {
                Node::Product(vec![self.factor(*a, done), self.factor(*b, done)])
            }
        }
    }
}

/// The product with the pair as one factor in the place of its first; nothing where it does not hold the pair and more.
fn without(factors: &[usize], (a, b): Pair, new: usize) -> Option<Vec<usize>> {
    let first = factors.iter().position(|factor| *factor == a)?;
    let second = factors[first + 1..]
        .iter()
        .position(|factor| *factor == b)?
        + first
        + 1;
    let mut shorter = factors.to_vec();
    shorter.remove(second);
    shorter[first] = new;
    (factors.len() > 2).then_some(shorter)
}
