//! Combinations of values of the parameters, in a fixed order.

/// One value of each list, the first list counting fastest; at most so many combinations.
pub fn combinations(choices: &[Vec<f64>], most: usize) -> impl Iterator<Item = Vec<f64>> {
    let sizes = choices.iter().map(Vec::len);
    let count = sizes.fold(1, |count: usize, size| count.saturating_mul(size));
    (0..count.min(most)).map(|n| combination(choices, n))
}

fn combination(choices: &[Vec<f64>], mut n: usize) -> Vec<f64> {
    let mut digit = |values: &Vec<f64>| {
        let value = values[n % values.len()];
        n /= values.len();
        value
    };
    choices.iter().map(&mut digit).collect()
}

#[cfg(test)]
mod tests {
    use super::combinations;

    #[test]
    fn the_first_list_counts_fastest() {
        let choices = [vec![1.0, 2.0], vec![3.0, 4.0]];
        let all: Vec<Vec<f64>> = combinations(&choices, 9).collect();
        assert_eq!(all, [[1.0, 3.0], [2.0, 3.0], [1.0, 4.0], [2.0, 4.0]]);
        assert_eq!(combinations(&choices, 3).count(), 3);
        assert_eq!(combinations(&[], 3).count(), 1);
        assert_eq!(combinations(&[vec![], vec![1.0]], 3).count(), 0);
    }
}
