//! The operations that documentation and pages tell of group functions are those that the runtime does.

use hamel_codegen::emit::method::group::FUNCTIONS;

#[test]
fn group_functions_do_the_operations_that_are_told() {
    let told = FUNCTIONS.iter().map(|row| {
        let c = row.counts;
        let counts = [
            c.additions,
            c.multiplications,
            c.fused,
            c.divisions,
            c.calls,
        ];
        (row.group, row.name, counts)
    });
    let told: Vec<_> = told.collect();
    let counted = hamel_tests::operations::counted();
    assert_eq!(counted.len(), told.len());
    for row in counted {
        assert!(told.contains(&row), "counted {row:?}");
    }
}
