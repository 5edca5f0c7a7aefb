//! Panels with two logarithmic axes, and the legend beside them.

use super::refused;
use super::style::{FONT, GRID, LABEL, Look, Mark, QUIET, TITLE, decade};
use hamel_console::output::Failure;
use itertools::Itertools;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Width of the legend, px.
const LEGEND: u32 = 190;
/// Height of a line of it, and of its first one.
const LINE: i32 = 20;
const FIRST: i32 = 44;

/// Lines that are to be dashed are drawn with this opacity, which [`responsive`] replaces by dashes. The library for figures would draw each dash as a line of its own: a page
/// of them is megabytes.
const DASHED: f64 = 0.999;

/// Points of one colour.
#[derive(Clone, Debug)]
pub struct Curve {
    pub label: String,
    pub look: Look,
    pub points: Vec<(f64, f64)>,
    /// Where runs failed, on the horizontal axis; drawn as crosses at the upper edge.
    pub failures: Vec<f64>,
}

/// One panel.
#[derive(Clone, Debug)]
pub struct Panel {
    pub title: String,
    pub horizontal: String,
    pub vertical: String,
    pub curves: Vec<Curve>,
    /// A horizontal line, and what it is.
    pub floor: Option<(f64, String)>,
    /// Whether lines join the points.
    pub marks: bool,
}

/// Panels side by side, and one legend of all their curves, for which the figure becomes higher where it is long.
pub fn figure(panels: &[Panel], width: u32, height: u32) -> Result<String, Failure> {
    let known = known(panels);
    let height = height.max((FIRST + LINE * known.len() as i32).unsigned_abs());
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
        root.fill(&WHITE).map_err(refused)?;
        let (left, right) = root.split_horizontally(width - LEGEND);
        for (area, panel) in left.split_evenly((1, panels.len())).iter().zip(panels) {
            draw(area, panel)?;
        }
        legend(&right, &known)?;
        root.present().map_err(refused)?;
    }
    Ok(responsive(&text, width, height))
}

/// The drawing with its size left to the page, with dashes, and without what SVG takes for granted.
fn responsive(text: &str, width: u32, height: u32) -> String {
    let fixed = format!("<svg width=\"{width}\" height=\"{height}\" ");
    let dashed = format!(" opacity=\"{DASHED}\"");
    text.replacen(&fixed, "<svg role=\"img\" ", 1)
        .replace(&dashed, " stroke-dasharray=\"6 4\"")
        .replace(" opacity=\"1\"", "")
}

/// Whole decades around positive finite values.
fn decades(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let values = values.filter(|value| *value > 0.0 && value.is_finite());
    let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    (least <= most).then(|| {
        let bottom = least.log10().floor();
        let top = most.log10().ceil().max(bottom + 1.0);
        10.0_f64.powf(bottom)..10.0_f64.powf(top)
    })
}

fn draw(area: &Area<'_>, panel: &Panel) -> Result<(), Failure> {
    let points = || panel.curves.iter().flat_map(|curve| &curve.points);
    let failures = panel.curves.iter().flat_map(|curve| &curve.failures);
    let floor = panel.floor.iter().map(|(floor, _)| *floor);
    let across = decades(points().map(|point| point.0).chain(failures.copied()));
    let upward = decades(points().map(|point| point.1).chain(floor));
    let (Some(across), Some(upward)) = (across, upward) else {
        return nothing(area, panel);
    };
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(22)
        .caption(&panel.title, (FONT, TITLE))
        .x_label_area_size(46)
        .y_label_area_size(62)
        .build_cartesian_2d(across.clone().log_scale(), upward.clone().log_scale())
        .map_err(refused)?;
    let letters = (FONT, LABEL).into_font();
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(BLACK)
        .x_labels(count(&across))
        .y_labels(count(&upward))
        .label_style(letters)
        .x_label_formatter(&|x| decade(*x))
        .y_label_formatter(&|y| decade(*y))
        .x_desc(&panel.horizontal)
        .y_desc(&panel.vertical)
        .draw()
        .map_err(refused)?;
    if let Some((floor, label)) = &panel.floor {
        let line = [(across.start, *floor), (across.end, *floor)];
        chart
            .draw_series(LineSeries::new(line, QUIET.mix(DASHED).stroke_width(1)))
            .map_err(refused)?;
        let place = (across.start, *floor);
        let letters = (FONT, LABEL - 2).into_font().color(&QUIET);
        let written = EmptyElement::at(place) + Text::new(label.clone(), (6, -15), letters);
        chart.draw_series([written]).map_err(refused)?;
    }
    for curve in &panel.curves {
        let line = curve.points.iter().copied();
        let line = LineSeries::new(line, stroke(&curve.look));
        chart.draw_series(line).map_err(refused)?;
        if panel.marks {
            for &at in &curve.points {
                let mark = shape(at, &curve.look);
                chart.plotting_area().draw(&mark).map_err(refused)?;
            }
        }
        let crosses = curve.failures.iter().map(|&x| {
            let style = curve.look.colour.stroke_width(2);
            let a = PathElement::new([(-5, 3), (5, 13)], style);
            let b = PathElement::new([(-5, 13), (5, 3)], style);
            EmptyElement::at((x, upward.end)) + a + b
        });
        chart.draw_series(crosses).map_err(refused)?;
    }
    Ok(())
}

/// How the line of a curve is drawn.
fn stroke(look: &Look) -> ShapeStyle {
    let opacity = if look.dashed { DASHED } else { 1.0 };
    look.colour.mix(opacity).stroke_width(2)
}

/// Labels that a range of decades has room for.
fn count(range: &Range<f64>) -> usize {
    let decades = (range.end / range.start).log10().round() as usize;
    (decades + 1).clamp(2, 9)
}

fn nothing(area: &Area<'_>, panel: &Panel) -> Result<(), Failure> {
    let letters = (FONT, LABEL).into_font().color(&QUIET);
    let note = Text::new(
        format!("{}: no run came to its end", panel.title),
        (20, 40),
        letters,
    );
    area.draw(&note).map_err(refused)
}

/// The mark of a curve at a point; hollow on a dashed curve.
fn shape<'a, DB: DrawingBackend + 'a, C: Clone + 'a>(at: C, look: &Look) -> DynElement<'a, DB, C> {
    let style: ShapeStyle = match look.dashed {
        true => look.colour.stroke_width(2),
        false => look.colour.filled(),
    };
    let outline = |points: Vec<(i32, i32)>| match look.dashed {
        true => {
            let closed = points.iter().chain(points.first()).copied();
            (EmptyElement::at(at.clone()) + PathElement::new(closed.collect::<Vec<_>>(), style))
                .into_dyn()
        }
        false => (EmptyElement::at(at.clone()) + Polygon::new(points, style)).into_dyn(),
    };
    match look.mark {
        Mark::Circle => Circle::new(at, 4, style).into_dyn(),
        Mark::Square => outline(vec![(-4, -4), (4, -4), (4, 4), (-4, 4)]),
        Mark::Triangle => outline(vec![(-5, 4), (5, 4), (0, -5)]),
        Mark::Diamond => outline(vec![(-5, 0), (0, -5), (5, 0), (0, 5)]),
    }
}

/// Curves of all panels, one of each label.
fn known(panels: &[Panel]) -> Vec<&Curve> {
    let curves = panels.iter().flat_map(|panel| &panel.curves);
    curves.unique_by(|curve| &curve.label).collect()
}

fn legend(area: &Area<'_>, curves: &[&Curve]) -> Result<(), Failure> {
    for (i, curve) in curves.iter().enumerate() {
        let y = FIRST + LINE * i as i32;
        let line = PathElement::new([(4, y), (34, y)], stroke(&curve.look));
        area.draw(&line).map_err(refused)?;
        area.draw(&shape((19, y), &curve.look)).map_err(refused)?;
        let letters = (FONT, LABEL - 1).into_font();
        let text = Text::new(curve.label.clone(), (42, y - 7), letters);
        area.draw(&text).map_err(refused)?;
    }
    Ok(())
}
