//! Every error code is explained: its page has a wrong spec with that error and a right one without any.

use hamel_codegen::spec::code;

/// The codes without a spec on their pages: a group without closed form, which no known manifold is, and a claim that follows from
/// those before it.
const WITHOUT_EXAMPLE: [&str; 2] = [code::NO_CLOSED_FORM, code::TWIST_MAP_SLOPE];

/// The specs on a page, wrong before right.
fn examples(page: &str) -> Vec<&str> {
    let blocks = page.split("```joint\n").skip(1);
    blocks
        .map(|block| block.split("```").next().unwrap_or_default())
        .collect()
}

/// The example of a file that is too large, whose second line stands for a thousand.
fn in_full(example: &str) -> String {
    let mut lines = example.split_inclusive('\n');
    let (version, prose) = (lines.next(), lines.next().expect("prose"));
    let repeated = prose.repeat(1000);
    version
        .into_iter()
        .chain([repeated.as_str()])
        .chain(lines)
        .collect()
}

fn codes_of(example: &str) -> Vec<&'static str> {
    match hamel_codegen::derive(example, "example.joint") {
        Ok(_) => vec![],
        Err(errors) => errors.errors.iter().map(|error| error.code).collect(),
    }
}

#[test]
fn examples_have_the_error_and_its_correction_has_none() {
    for (code, _) in code::ALL {
        let page = code::explain(code).expect("every code has a page");
        let examples = examples(&page);
        if WITHOUT_EXAMPLE.contains(code) {
            assert!(examples.is_empty(), "{code} has an example by now");
            continue;
        }
        let [wrong, right] = examples.as_slice() else {
            panic!("{code} has {} examples", examples.len());
        };
        let found = match *code {
            code::SIZE => codes_of(&in_full(wrong)),
            _ => codes_of(wrong),
        };
        assert!(found.contains(code), "{code}: the wrong spec has {found:?}");
        assert_eq!(codes_of(right), [""; 0], "{code}: the right spec");
    }
}

#[test]
fn codes_are_found_in_any_spelling() {
    let page = code::explain("E0305").expect("a code");
    assert!(page.starts_with("E0305: A basis that does not close under the bracket.\n"));
    for spelling in ["e0305", "305", "0305", "E305"] {
        assert_eq!(code::explain(spelling), Ok(page.clone()), "{spelling}");
    }
    assert_eq!(code::explain("E0035"), Err(Some("E0305")));
    assert_eq!(code::explain("E9419"), Err(Some("E0419")));
    for unlike in ["E9999", "", "🦀"] {
        assert_eq!(code::explain(unlike), Err(None), "{unlike}");
    }
}

#[test]
fn codes_ascend() {
    assert!(code::ALL.windows(2).all(|pair| pair[0].0 < pair[1].0));
}
