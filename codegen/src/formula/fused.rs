//! Sums that hold products, as multiply–adds: one rounding less for each, and one instruction where the target has it.
//!
//! A difference of two products stays as it is: it vanishes exactly where both products are equal, as the bracket of
//! parallel vectors must, while a fused form would leave the rounding of one of them. Products with such a difference as a
//! factor stay as well: expansions of determinants read best as sums.

use super::Node;

/// A term of a sum: whether it is subtracted, and its size.
type Signed = (bool, Node);

/// A sum as `a · b + (c · d + … + rest)`.
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    /// The products that are fused, outermost first: whether it is subtracted, all factors but the last, the last.
    pub products: Vec<(bool, &'a [Node], &'a Node)>,
    /// What the innermost is added to: the terms that are no products, or the last product.
    pub rest: Vec<&'a Signed>,
}

impl<'a> Chain<'a> {
    /// The sum of the terms as a chain; nothing where no product is fused.
    pub fn new(terms: &'a [Signed]) -> Option<Self> {
        if is_difference_of_products(terms) {
            return None;
        }
        let (products, mut rest): (Vec<&Signed>, Vec<&Signed>) =
            terms.iter().partition(|(_, term)| is_fusible(term));
        let mut products = products;
        if rest.is_empty() {
            // Reading order ends with a term that needs no sign in front, where there is one.
            let plus = products.iter().rposition(|(minus, _)| !minus)?;
            rest.push(products.remove(plus));
        }
        let products: Vec<_> = products.into_iter().filter_map(split).collect();
        (!products.is_empty()).then_some(Self { products, rest })
    }
}

fn is_difference_of_products(terms: &[Signed]) -> bool {
    matches!(terms, [(a, Node::Product(_)), (b, Node::Product(_))] if a != b)
}

fn is_fusible(term: &Node) -> bool {
    let is_difference =
        |factor: &Node| matches!(factor, Node::Sum(terms) if is_difference_of_products(terms));
    matches!(term, Node::Product(factors) if !factors.iter().any(is_difference))
}

fn split((minus, term): &Signed) -> Option<(bool, &[Node], &Node)> {
    let Node::Product(factors) = term else {
        return None;
    };
    let (last, others) = factors.split_last()?;
    Some((*minus, others, last))
}
