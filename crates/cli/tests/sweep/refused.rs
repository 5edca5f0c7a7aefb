//! What is refused before anything moves, word for word.

use super::pendulums;

/// Of tables that are refused, with what is said.
const TABLES: [(&str, &str); 11] = [
    (
        "body.arm.mas,body.leg.mass,gravty.3\n1,1,1\n",
        "error: column `body.arm.mas`: in `body.arm`: the scene has no `mas` there; did you mean `mass`?\n\
         error: column `body.leg.mass`: in `body`: the scene has no `leg` there; it has `arm`. A column names a number that the scene file has\n\
         error: column `gravty.3`: the scene has no `gravty` there; did you mean `gravity`?\n",
    ),
    (
        "gravity\n1\n",
        "error: column `gravity`: it is a list, of which a column takes one number: `gravity.1` to `gravity.3`\n",
    ),
    (
        "gravity.0\n1\n",
        "error: column `gravity.0`: in `gravity`: there is no item `0`: it is a list of 3, counted from 1\n",
    ),
    (
        "body.arm.initial\n1\n",
        "error: column `body.arm.initial`: it is a table, of which a column takes one number: `configuration`, `speeds`\n",
    ),
    (
        "body.arm.name\n1\n",
        "error: column `body.arm.name`: it is a string in the scene, and a column takes a number\n",
    ),
    (
        "body.arm.mass.1\n1\n",
        "error: column `body.arm.mass.1`: in `body.arm.mass`: a float has no `1`\n",
    ),
    (
        "body.arm.mass,body.1.mass\n1,1\n",
        "error: columns `body.arm.mass` and `body.1.mass` name the same number\n",
    ),
    (
        "body..mass\n1\n",
        "error: column `body..mass`: a key is empty: keys stand between dots, such as `body.arm.mass`\n",
    ),
    (
        "body.\"\"arm.mass\n1\n",
        "error: column `body.\"\"arm.mass`: a key is empty: keys stand between dots, such as `body.arm.mass`\n",
    ),
    ("body.arm.mass\n", "error: table.csv has no rows\n"),
    ("", "error: table.csv has no columns\n"),
];

#[test]
fn columns_that_change_nothing_are_refused_at_once() {
    let place = pendulums(0);
    for (table, wanted) in TABLES {
        place.write("table.csv", table);
        let said = place.refused("sweep pendulum.toml --over table.csv -o out", 2);
        assert_eq!(said, wanted);
        assert!(!place.path("out").exists());
    }
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let place = pendulums(3);
    place.write("table.txt", "body.arm.mass\n1\n");
    for (words, code, wanted) in [
        (
            "--over table.txt -o out",
            2,
            "error: table.txt is no table: its name must end in .csv or .parquet\n",
        ),
        (
            "--over none.csv -o out",
            1,
            "error: cannot read none.csv: No such file or directory (os error 2)\n",
        ),
        (
            "--over table.csv --scene-of 4",
            2,
            "error: --scene-of is 4, and table.csv has 3 rows\n",
        ),
    ] {
        assert_eq!(
            place.refused(&format!("sweep pendulum.toml {words}"), code),
            wanted
        );
    }
    place.write("table.csv", "body.arm.mass\nx\n");
    assert_eq!(
        place.refused("sweep pendulum.toml --over table.csv --scene-of 1", 1),
        "error: row 1 has no scene: column `body.arm.mass`: the cell `x` is no number\n"
    );
    // A scene with mistakes is told as everywhere.
    place.write("pendulum.toml", "hamel = 1\n");
    let said = place.refused("sweep pendulum.toml --over table.csv -o out", 1);
    assert!(said.contains("the scene has no body"), "{said}");
}

#[test]
fn a_folder_of_another_sweep_is_left_alone() {
    let place = pendulums(10);
    let words = "sweep pendulum.toml --over table.csv -o out --no-error-estimate";
    place.done(&format!("{words} --quiet"));
    let before = place.read("out/part-000001.csv");
    let refused = |words: &str| {
        let said = place.refused(words, 2);
        assert_eq!(place.read("out/part-000001.csv"), before);
        said
    };
    let first =
        "error: out holds the results of another sweep, and stays as it is: name another folder\n";
    assert_eq!(
        refused("sweep pendulum.toml --over table.csv -o out --block 3"),
        format!(
            "{first}  --block was 8 rows, and is 3 rows\n  the error estimate was left out, and is there\n"
        )
    );
    assert_eq!(
        refused(&format!("{words} --format parquet")),
        format!("{first}  the format was csv, and is parquet\n")
    );
    place.write("table.csv", "body.arm.mass\n1\n");
    let said = refused(words);
    assert!(
        said.starts_with(&format!("{first}  the table was table.csv of ")),
        "{said}"
    );
    assert!(
        said.ends_with(" and is table.csv of 16 bytes with the sum 79e81ce6301186e6\n"),
        "{said}"
    );
}

#[test]
fn a_folder_of_something_else_is_left_alone() {
    let place = pendulums(3);
    std::fs::create_dir(place.path("out")).expect("a folder");
    place.write("out/thesis.tex", "years");
    let words = "sweep pendulum.toml --over table.csv -o out";
    assert_eq!(
        place.refused(words, 2),
        "error: out holds thesis.tex and no sweep.json: name a folder of its own for the results\n"
    );
    place.write("out/sweep.json", "{}");
    assert_eq!(
        place.refused(words, 2),
        "error: out/sweep.json does not tell of a sweep: name another folder\n"
    );
    // Nor is a file in a part's place read for one.
    std::fs::remove_dir_all(place.path("out")).expect("a folder");
    place.done(&format!("{words} --quiet"));
    place.write("out/part-000001.csv", "row,outcome\n7,ended\n");
    assert_eq!(
        place.refused(words, 1),
        "error: cannot read out/part-000001.csv: it is no part of these results\n"
    );
}
