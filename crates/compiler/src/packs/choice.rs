//! Packs that cost less than their nodes.

use super::{Pack, Packs};
use crate::graph::Operation;
use rustc_hash::{FxHashMap, FxHashSet};

/// The cost in operations of a number that is put side by side with itself.
const BROADCAST: f64 = 0.25;

/// That of numbers that are put side by side.
const fn gathered(count: usize) -> f64 {
    count as f64 - 1.0
}

/// That of extracting the numbers of a pack.
const fn extracted(count: usize) -> f64 {
    count as f64 / 2.0
}

/// What a pack reads in one place.
enum Operands {
    /// Another pack as it is.
    Pack,
    /// Numbers.
    Numbers,
    /// One node.
    Same,
    /// Several, all of packs: so many of these.
    Packs(usize),
    /// Several.
    Several,
}

impl Packs {
    /// Leaves out packs that do not pay. The cost of all nodes one by one, and with the packs that remain.
    pub(super) fn choose(&mut self, uses: &[u32]) -> [f64; 2] {
        loop {
            let given = self.given(uses);
            let read = self.readers();
            let gains: Vec<f64> = (0..self.packs.len())
                .map(|pack| self.gain(pack, &given, &read))
                .collect();
            // The worst first: what reads them may pay without them.
            let least = gains.iter().copied().fold(0.0, f64::min) / 2.0;
            let before = self.packs.len();
            let mut gains = gains.into_iter();
            self.packs
                .retain(|_| gains.next().is_some_and(|gain| gain > least || gain >= 0.0));
            if self.packs.len() == before {
                break;
            }
            self.settle();
        }
        self.costs(uses)
    }

    /// Nodes that are read one by one: by what is no pack, and by packs that put them side by side.
    fn given(&self, uses: &[u32]) -> FxHashSet<u32> {
        let mut given: FxHashSet<u32> = self.outputs.iter().map(|output| output.node).collect();
        for (number, node) in self.graph.nodes.iter().enumerate() {
            if uses[number] > 0 && self.home[number].is_none() {
                node.operation.each_operand(|operand| {
                    given.insert(operand);
                });
            }
        }
        for nodes in (0..self.packs.len()).flat_map(|pack| self.slots(pack)) {
            if matches!(self.operands(&nodes), Operands::Several) {
                given.extend(nodes);
            }
        }
        given
    }

    /// What a pack reads, place by place.
    pub fn slots(&self, pack: usize) -> Vec<Vec<u32>> {
        let operands = &self.packs[pack].operands;
        let place = |place: usize| operands.iter().map(|own| own[place]).collect();
        (0..operands[0].len()).map(place).collect()
    }

    fn operands(&self, nodes: &[u32]) -> Operands {
        let is_number = |node: &u32| {
            matches!(
                self.graph.nodes[*node as usize].operation,
                Operation::Constant(_)
            )
        };
        if self.holding(nodes).is_some() {
            Operands::Pack
        } else if nodes.iter().all(is_number) {
            Operands::Numbers
        } else if nodes.iter().all(|node| *node == nodes[0]) {
            Operands::Same
        } else {
            let mut homes: Vec<Option<usize>> =
                nodes.iter().map(|&node| self.home[node as usize]).collect();
            homes.sort_unstable();
            homes.dedup();
            match homes.iter().all(Option::is_some) {
                true => Operands::Packs(homes.len()),
                false => Operands::Several,
            }
        }
    }

    /// The cost of putting nodes side by side that a pack reads in one place.
    fn carried(&self, nodes: &[u32]) -> f64 {
        match self.operands(nodes) {
            Operands::Pack | Operands::Numbers => 0.0,
            Operands::Same => BROADCAST,
            Operands::Packs(count) => count as f64,
            Operands::Several => gathered(nodes.len()),
        }
    }

    /// How many packs read these nodes in one place.
    fn readers(&self) -> FxHashMap<Vec<u32>, usize> {
        let mut readers = FxHashMap::default();
        for number in 0..self.packs.len() {
            for nodes in self.slots(number) {
                *readers.entry(nodes).or_insert(0) += 1;
            }
        }
        readers
    }

    /// Operations that a pack saves; what it shares with others counts in part.
    fn gain(
        &self,
        pack: usize,
        given: &FxHashSet<u32>,
        readers: &FxHashMap<Vec<u32>, usize>,
    ) -> f64 {
        let own = &self.packs[pack].nodes;
        let mut gain = own.len() as f64 - 1.0;
        for nodes in self.slots(pack) {
            let share = 1.0 / readers.get(&nodes).copied().unwrap_or(1) as f64;
            gain -= share * self.carried(&nodes);
        }
        if own.iter().any(|node| given.contains(node)) {
            gain -= extracted(own.len());
        }
        // One by one, those that read the pack would have to put its nodes side by side.
        if readers.contains_key(own) {
            gain += gathered(own.len());
        }
        gain
    }

    /// Operations one by one, and with packs.
    fn costs(&self, uses: &[u32]) -> [f64; 2] {
        let computes = |node: usize| {
            !matches!(
                self.graph.nodes[node].operation,
                Operation::Input(..) | Operation::Constant(_) | Operation::Part(..)
            )
        };
        let needed = (0..self.graph.nodes.len()).filter(|&node| uses[node] > 0 && computes(node));
        let (packed, single): (Vec<usize>, Vec<usize>) =
            needed.partition(|&node| self.home[node].is_some());
        let given = self.given(uses);
        let readers = self.readers();
        let carried: f64 = readers.keys().map(|nodes| self.carried(nodes)).sum();
        let given = |pack: &&Pack| pack.nodes.iter().any(|node| given.contains(node));
        let extraction: f64 = self
            .packs
            .iter()
            .filter(given)
            .map(|pack| extracted(pack.nodes.len()))
            .sum();
        [
            (packed.len() + single.len()) as f64,
            (self.packs.len() + single.len()) as f64 + carried + extraction,
        ]
    }
}
