//! Functions of time: values and slopes of formulas and tables, their kinks, and what is refused.

use hamel_runtime::time_function::{
    Expression, Law, Moment, Outside, Table, TableError, TableKind, TimeFunction,
};
use std::f64::consts::PI;
use std::sync::Arc;

fn formula(text: &str) -> TimeFunction {
    let expression = Expression::new(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    TimeFunction::Expression(Arc::new(expression))
}

fn table(
    points: &[(f64, f64)],
    kind: TableKind,
    outside: Outside,
) -> Result<TimeFunction, TableError> {
    let (times, values) = points.iter().copied().unzip();
    Table::new(times, values, kind, outside).map(|table| TimeFunction::Table(Arc::new(table)))
}

fn value(function: &TimeFunction, time: f64) -> f64 {
    function.value(time.into())
}

#[test]
fn formulas_have_their_values() {
    let t = 0.7_f64;
    let cases = [
        ("1 + 2*3 - 4/8", 6.5),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2 - - 3", 5.0),
        ("1.5e-3*t", 1.5e-3 * t),
        ("(1 + t)*(1 - t)", 1.0 - t * t),
        ("sin(2*pi*t)", (2.0 * PI * t).sin()),
        ("0.5*cos(t) + tan(t)", 0.5 * t.cos() + t.tan()),
        ("exp(-t) + log(t) + sqrt(t)", (-t).exp() + t.ln() + t.sqrt()),
        ("abs(t - 1)", 1.0 - t),
        ("min(t, 0.5) + max(t, 0.5)", 1.2),
        ("step(t - 0.7) + step(t - 0.71)", 1.0),
        ("t^2.5 + t^t", t.powf(2.5) + t.powf(t)),
        ("(t - 1)^3", (t - 1.0).powi(3)),
        ("2^-2147483648 + abs(t)^2147483647", 0.0),
    ];
    for (text, expected) in cases {
        let found = value(&formula(text), t);
        // A few roundings of numbers of at most 512.
        assert!(
            (found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs().max(1.0),
            "{text}: {found}"
        );
    }
}

/// Central differences with a step of 1e-5 are exact to 1e-10 times third derivatives, which are below 1e3 here.
#[test]
fn slopes_are_those_of_the_values() -> Result<(), TableError> {
    let points = [(0.0, 1.0), (0.4, -2.0), (1.0, 3.0), (1.7, 1.0)];
    let functions = [
        formula("0.5*sin(2*pi*t) + exp(-t)*t^3 - log(1 + t)/sqrt(2 + t)"),
        formula("tan(t/3)^2 + t^1.5 + (1 + t)^t - 3/(1 + t^2)"),
        formula("abs(sin(3*t)) + max(t^2, cos(t)) + min(t, 1 - t)*step(t - 0.1)"),
        table(&points, TableKind::Linear, Outside::Hold)?,
        table(&points, TableKind::Cubic, Outside::Hold)?,
        table(&points, TableKind::Cubic, Outside::Repeat)?,
    ];
    for function in functions {
        for i in 1..40 {
            let (time, change) = (0.0371 * f64::from(i) + 0.11, 1e-5);
            let difference = value(&function, time + change) - value(&function, time - change);
            let (expected, found) = (difference / (2.0 * change), function.slope(time.into()));
            assert!(
                (found - expected).abs() < 1e-7,
                "{function:?} at {time}: {found} for {expected}"
            );
        }
    }
    Ok(())
}

/// All kinks up to a time.
fn kinks(function: &TimeFunction, until: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    let mut after = 0.0;
    while let Some(kink) = function
        .next_kink(after, until)
        .expect("they can be followed")
    {
        found.push(kink);
        after = kink;
    }
    found
}

#[test]
fn kinks_are_found_where_arguments_change_their_sign() {
    let half = |i: i32| PI * f64::from(i) / 3.0;
    let cases: [(&str, Vec<f64>); 7] = [
        ("sin(t) + 2", vec![]),
        ("step(t - 0.3) + abs(2*t - 1)", vec![0.3, 0.5]),
        ("abs(sin(3*t))", (1..=5).map(half).collect()),
        ("abs(sin(3*t)^2)", vec![]),
        ("max(t, t^2 - 2)", vec![2.0]),
        ("step(0.5 - abs(t - 1))", vec![0.5, 1.0, 1.5]),
        (
            "min(0, max(-1, (t - 1)*(t - 2)*(t - 4)))",
            vec![0.753, 1.0, 2.0, 2.445, 3.802, 4.0],
        ),
    ];
    for (text, expected) in cases {
        let found = kinks(&formula(text), 5.5);
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 0.1;
        let all = found.iter().zip(&expected).all(is_near);
        assert!(
            found.len() == expected.len() && all,
            "{text}: {found:?} for {expected:?}"
        );
    }
    let exact = kinks(&formula("abs(sin(3*t))"), 5.5);
    let far = exact
        .iter()
        .enumerate()
        .map(|(i, kink)| (kink - PI * (i + 1) as f64 / 3.0).abs());
    // A rounding of the argument, up to 16, over its rate of 3.
    assert!(far.fold(0.0, f64::max) < 4.0 * f64::EPSILON * 5.3);
}

/// Far and fast ones are found one by one.
#[test]
fn many_kinks_are_followed() {
    let function = formula("step(sin(100*t))");
    let kink = function
        .next_kink(1000.0, 2000.0)
        .expect("it can be followed");
    let expected = (1000.0 * 100.0 / PI).ceil() * PI / 100.0;
    assert!((kink.expect("there are many") - expected).abs() < 1e-11);
}

#[test]
fn arguments_that_cannot_be_followed_are_named() {
    for text in [
        "abs((t + 1)^2 - t^2 - 2*t - 1)",
        "step(sin(t)^2 + cos(t)^2 - 1)",
    ] {
        let error = formula(text)
            .next_kink(0.0, 1.0)
            .expect_err(text)
            .to_string();
        assert!(
            error.contains(text) && error.contains("changes its sign too often"),
            "{error}"
        );
    }
}

/// The piece is that of `within`, on either side of a kink.
#[test]
fn both_limits_are_told_apart() -> Result<(), TableError> {
    let at = |within| Moment { time: 1.0, within };
    let points = [(0.0, 2.0), (1.0, 5.0), (3.0, 7.0)];
    let steps = table(&points, TableKind::Constant, Outside::Repeat)?;
    assert_eq!([0.9, 1.1].map(|within| steps.value(at(within))), [2.0, 5.0]);
    assert_eq!(
        [0.5, 3.5].map(|within| steps.value(Moment { time: 3.0, within })),
        [2.0, 2.0]
    );
    let line = table(&points, TableKind::Linear, Outside::Zero)?;
    assert_eq!([0.9, 1.1].map(|within| line.slope(at(within))), [3.0, 1.0]);
    let jump = formula("step(t - 1)*t + abs(t - 1)");
    assert_eq!([0.9, 1.1].map(|within| jump.value(at(within))), [0.0, 1.0]);
    assert_eq!([0.9, 1.1].map(|within| jump.slope(at(within))), [-1.0, 2.0]);
    Ok(())
}

#[test]
fn tables_go_on_as_they_are_told() -> Result<(), TableError> {
    let points = [(1.0, 2.0), (2.0, 5.0), (4.0, 2.0)];
    let values = |kind, outside| -> Result<[f64; 4], TableError> {
        let table = table(&points, kind, outside)?;
        Ok([0.5, 1.5, 4.5, 5.0].map(|time| value(&table, time)))
    };
    use {Outside::*, TableKind::*};
    assert_eq!(values(Constant, Hold)?, [2.0, 2.0, 2.0, 2.0]);
    assert_eq!(values(Linear, Zero)?, [0.0, 3.5, 0.0, 0.0]);
    assert_eq!(values(Linear, Repeat)?, [2.75, 3.5, 3.5, 5.0]);
    let repeating = table(&points, Linear, Repeat)?;
    assert_eq!(kinks(&repeating, 8.5), [1.0, 2.0, 4.0, 5.0, 7.0, 8.0]);
    let held = table(&points, Cubic, Hold)?;
    assert_eq!(kinks(&held, 8.5), [1.0, 4.0]);
    assert_eq!(kinks(&table(&points, Cubic, Repeat)?, 8.5), []);
    Ok(())
}

/// A natural spline has no second derivative at its ends, one that repeats the same at both, and all have none that jumps.
#[test]
fn cubics_have_continuous_second_derivatives() -> Result<(), TableError> {
    let points = [(0.0, 1.0), (0.4, -2.0), (1.0, 3.0), (1.7, 1.0)];
    let small = 1e-4;
    let bend = |function: &TimeFunction, time: f64| {
        let slope = |time: f64| function.slope(time.into());
        (slope(time + small) - slope(time - small)) / (2.0 * small)
    };
    for outside in [Outside::Hold, Outside::Repeat] {
        let spline = table(&points, TableKind::Cubic, outside)?;
        for (time, expected) in points {
            // A table that is held has its last value and no slope beyond its end.
            assert!((value(&spline, time) - expected).abs() < 1e-14);
        }
        for knot in [0.4, 1.0] {
            let jump = bend(&spline, knot + 2.0 * small) - bend(&spline, knot - 2.0 * small);
            // The third derivative, some 1e3, over 4e-4.
            assert!(jump.abs() < 0.5, "{outside:?}: {jump} at {knot}");
        }
        match outside {
            Outside::Repeat => {
                let jump = bend(&spline, 2.0 * small) - bend(&spline, 1.7 - 2.0 * small);
                assert!(jump.abs() < 0.5, "{jump}");
            }
            _ => assert!(bend(&spline, 2.0 * small).abs() < 0.5),
        }
    }
    Ok(())
}

#[test]
fn what_cannot_be_read_is_shown_where_it_is() {
    let cases = [
        ("", 1, "found the end"),
        ("1 +", 4, "found the end"),
        ("sin t", 5, "expected `(` before the argument, found `t`"),
        ("2*x", 3, "`x` is not known"),
        (
            "(1 + t",
            7,
            "expected `)` that closes a parenthesis, found the end",
        ),
        ("min(t)", 6, "expected `,` between two arguments, found `)`"),
        ("1 2", 3, "expected an operator, found `2`"),
        ("1.2.3", 1, "`1.2.3` is not a number"),
        ("1e999", 1, "`1e999` is not a number"),
        ("t ÷ 2", 3, "expected an operator, found `÷`"),
    ];
    for (text, character, message) in cases {
        let error = Expression::new(text).expect_err(text).to_string();
        let place = format!("at character {character}: ");
        assert!(
            error.starts_with(&place) && error.contains(message),
            "{text}: {error}"
        );
    }
    let deep = "(".repeat(1000);
    let error = Expression::new(&deep).expect_err("it is deep").to_string();
    assert!(error.contains("more than 100 levels"), "{error}");
    let signs = format!("{}t", "-".repeat(1001));
    let odd = Expression::new(&signs).expect("signs are no levels");
    assert_eq!(
        TimeFunction::Expression(Arc::new(odd)).value(2.0.into()),
        -2.0
    );
}

#[test]
fn numbers_that_make_no_table_are_refused() {
    let refused = |points: &[(f64, f64)], kind, outside| {
        table(points, kind, outside)
            .expect_err("no table")
            .to_string()
    };
    use {Outside::*, TableKind::*};
    let found = refused(&[(0.0, 1.0)], Linear, Hold);
    assert_eq!(found, "a table has at least 2 times, this one has 1");
    let found = refused(&[(0.0, 1.0), (2.0, 1.0), (2.0, 3.0)], Linear, Hold);
    assert_eq!(
        found,
        "time 3 is 2 s, it must be after the one before it, 2 s"
    );
    let found = refused(&[(0.0, 1.0), (2.0, f64::NAN)], Constant, Zero);
    assert_eq!(found, "entry 2 is NaN, it must be finite");
    let found = refused(&[(0.0, 1.0), (2.0, 1.5)], Cubic, Repeat);
    assert!(
        found.contains("it begins with 1 and ends with 1.5"),
        "{found}"
    );
}

/// Steps end before pulses, however short these are beside them, and within reach of their beginning.
#[test]
fn pulses_within_a_step_are_found() {
    for width in [1e-1, 1e-3, 1e-6, 1e-9] {
        for at in [3.0, 61.7, 999.0] {
            let pulses = [
                format!("exp(-((t - {at})/{width})^2)"),
                format!("2 + 0.3/(1 + ((t - {at})/{width})^4)"),
                format!("sin(50*t)*exp(-((t - {at})/{width})^2)"),
            ];
            for text in pulses {
                let end = formula(&text).end_before_pulse([0.0, 1000.0], [0.0, 1000.0]);
                assert!(end < at && end > 0.0, "{text}: {end}");
            }
            // A step from within a pulse is no longer than this.
            let text = format!("exp(-((t - {at})/{width})^2)");
            let next = formula(&text).end_before_pulse([at - width, 1000.0], [0.0, 1000.0]);
            assert!(next < at + 30.0 * width, "{text}: {next}");
        }
    }
}

/// A time that is beyond its piece by a rounding has the values of both pieces there, and roots have one.
#[test]
fn roundings_beyond_a_piece_leave_values_as_they_are() {
    for text in [
        "sqrt(abs(t - 1))",
        "abs(t - 1)^0.5",
        "sqrt(max(0, t - 1))",
        "sqrt(-min(0, t - 1))",
    ] {
        for (time, within) in [
            (1.0 - 4e-15, 1.5),
            (1.0 + 4e-15, 0.5),
            (1.0, 0.5),
            (1.0, 1.5),
        ] {
            let value = formula(text).value(Moment { time, within });
            assert!((0.0..1e-7).contains(&value), "{text} at {time}: {value}");
        }
    }
}

/// Where nothing bends, the piece is the whole motion, and tells nothing of the period.
#[test]
fn cubics_that_repeat_have_their_period_by_the_time() {
    let points = [
        (0.5, 0.0),
        (0.75, 1.0),
        (1.0, 0.0),
        (1.25, -1.0),
        (1.5, 0.0),
    ];
    let function = table(&points, TableKind::Cubic, Outside::Repeat).expect("a table");
    assert_eq!(function.next_kink(0.0, 1e3), Ok(None));
    for (time, expected) in [
        (0.75, 1.0),
        (7.75, 1.0),
        (8.25, -1.0),
        (-0.25, 1.0),
        (100.0, 0.0),
    ] {
        let at = Moment {
            time,
            within: 500.0,
        };
        let (value, slope) = (function.value(at), function.slope(at));
        assert!((value - expected).abs() < 1e-12, "{time}: {value}");
        assert_eq!(slope, function.slope(time.into()), "{time}");
    }
}

/// A peak between values of a cubic table that are 0 for long, once and again and again.
#[test]
fn pulses_of_cubic_tables_are_found() {
    let points = (0..=100).map(|i| (f64::from(i), f64::from(u8::from(i == 50))));
    let points: Vec<(f64, f64)> = points.collect();
    for (outside, from, at) in [
        (Outside::Hold, 1.0, 50.0),
        (Outside::Zero, 1.0, 50.0),
        (Outside::Repeat, 0.0, 50.0),
        (Outside::Repeat, 60.0, 150.0),
        (Outside::Repeat, 1060.0, 1150.0),
    ] {
        let function = table(&points, TableKind::Cubic, outside).expect("a table");
        let end = function.end_before_pulse([from, from + 1000.0], [0.0, 5000.0]);
        assert!(from < end && end < at, "{outside:?} from {from}: {end}");
        let short = [from + 0.25, from + 0.75];
        let end = function.end_before_pulse(short, [0.0, 5000.0]);
        assert_eq!(end, short[1], "{outside:?} from {from}");
    }
}

/// A pulse of a few per cent of what else changes within the step is no less one.
#[test]
fn pulses_on_a_slope_are_found() {
    for (slow, at) in [("t", 7.3), ("100*sin(t/5)", 3.1), ("exp(t/10)", 12.9)] {
        let text = format!("{slow} + 2*exp(-((t - {at})/0.001)^2)");
        let end = formula(&text).end_before_pulse([0.0, 15.0], [0.0, 20.0]);
        assert!(end < at && end > 0.0, "{text}: {end}");
    }
    let mut points: Vec<(f64, f64)> = (0..=2000).map(|i| (0.01 * f64::from(i), 0.0)).collect();
    for (time, value) in &mut points {
        *value = 10.0 * *time;
    }
    points[1000].1 += 20.0;
    let function = table(&points, TableKind::Cubic, Outside::Hold).expect("a table");
    let end = function.end_before_pulse([3.0, 18.0], [0.0, 20.0]);
    assert!(end < 10.0 && end > 3.0, "{end}");
}

/// A step has a period of what oscillates at most, wherever it begins, and however many periods it was to have.
#[test]
fn steps_do_not_pass_over_periods() {
    let period = core::f64::consts::TAU / 1000.0;
    let law = TimeFunction::Sine(Law {
        rate: 1.0,
        amplitude: 1e-6,
        frequency: 1000.0,
        phase: 0.3,
    });
    let points = (0..=200).map(|i| {
        let phase = f64::from(i) / 8.0;
        (period * phase, (core::f64::consts::TAU * phase).sin())
    });
    let points: Vec<(f64, f64)> = points.collect();
    let sampled = table(&points, TableKind::Cubic, Outside::Hold).expect("a table");
    let functions = [
        formula("sin(1000*t)"),
        formula("5 + 0.1*cos(1000*t)*exp(-t)"),
        law,
        sampled,
    ];
    for (place, function) in functions.iter().enumerate() {
        for start in 0..16 {
            let from = period * f64::from(start) / 16.0;
            for periods in [2.0, 4.0, 8.0, 9.5, 20.0] {
                let until = from + periods * period;
                let end = function.end_before_pulse([from, until], [0.0, 1.0]);
                // A distance of a hundredth of the range is that of 1.1 periods.
                assert!(
                    end > from && end < from + 1.2 * period,
                    "function {place} from {from}, {periods} periods: {}",
                    (end - from) / period
                );
            }
        }
    }
}

/// Steps that see what a function does are left as they are.
#[test]
fn smooth_steps_are_not_cut() {
    let cases = [
        ("sin(t)", 0.0, 1.0),
        ("sin(t)", 1.0, 2.2),
        ("sin(1000*t)", 0.0, 1e-3),
        ("exp(-t)", 0.0, 2.0),
        ("exp(-t)", 900.0, 1000.0),
        ("3", 0.0, 1e9),
        ("t^3 - 2*t", -5.0, 5.0),
        ("exp(-((t - 5)/0.01)^2)", 6.0, 1000.0),
        ("0*t", 0.0, 1e6),
        ("1/(t - 2)", 3.0, 4.0),
    ];
    for (text, from, until) in cases {
        let end = formula(text).end_before_pulse([from, until], [0.0, 1000.0]);
        assert_eq!(end, until, "{text} from {from} to {until}");
    }
}
