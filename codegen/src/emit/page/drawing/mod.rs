//! A drawing of a joint, made from its kernels: for each direction of its velocity, its bodies at home and swept along it.

mod parameters;
mod pen;
mod sampler;
mod scene;
mod sweep;
mod view;

use crate::derived::Derived;
use crate::emit::report::FreedomRow;
use pen::Pen;
use sampler::Sampler;
use scene::draw;
use sweep::{Direction, Sweep};
use view::View;

/// Width of a panel in pixels.
const WIDTH: f64 = 240.0;
/// Height of the drawn part of a panel in pixels.
const HEIGHT: f64 = 200.0;
/// Height of the caption below it in pixels.
const CAPTION: f64 = 26.0;

/// One panel a direction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    name: String,
    panels: Vec<Panel>,
}

/// The bodies swept along one direction.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Panel {
    caption: String,
    forbidden: bool,
    elements: String,
}

impl Drawing {
    /// Whether the joint has one.
    pub fn exists(derived: &Derived) -> bool {
        let Some(sampler) = parameters::sampler(derived) else {
            return false;
        };
        let home = sampler.home();
        let mut directions = Direction::all(derived.shape).into_iter();
        directions.any(|direction| Sweep::exists(&sampler, &home, direction))
    }

    /// The drawing of a joint; nothing where its pose cannot be evaluated at home for any parameters that were tried.
    pub fn new(derived: &Derived, freedoms: &[FreedomRow]) -> Option<Self> {
        let sampler = parameters::sampler(derived)?;
        let home = sampler.home();
        let swept: Vec<(Direction, Sweep)> = Direction::all(derived.shape)
            .into_iter()
            .filter_map(|direction| Some((direction, Sweep::new(&sampler, &home, direction)?)))
            .collect();
        let points = swept.iter().flat_map(|(_, sweep)| scene::extent(sweep));
        let view = View::fitting(points, WIDTH, HEIGHT);
        let panel = |(direction, sweep): &(Direction, Sweep)| {
            let mut pen = Pen::new(view);
            draw(&mut pen, sweep, direction.is_forbidden());
            Panel {
                caption: caption(derived, &sampler, *direction, freedoms),
                forbidden: direction.is_forbidden(),
                elements: pen.finish(),
            }
        };
        let panels: Vec<Panel> = swept.iter().map(panel).collect();
        let name = derived.spec.name.value.clone();
        (!panels.is_empty()).then_some(Self { name, panels })
    }

    /// All panels in one picture.
    pub fn sheet(&self) -> String {
        let count = self.panels.len();
        let columns = if count == 4 { 2 } else { count.min(3) };
        let rows = count.div_ceil(columns);
        let cell = |i: usize| {
            let (x, y) = (
                (i % columns) as f64 * WIDTH,
                (i / columns) as f64 * (HEIGHT + CAPTION),
            );
            (x, y)
        };
        let panels = self.panels.iter().enumerate().map(|(i, panel)| {
            let (x, y) = cell(i);
            format!(
                "<g transform=\"translate({x} {y})\">\n{}</g>\n",
                panel.with_caption()
            )
        });
        let size = (columns as f64 * WIDTH, rows as f64 * (HEIGHT + CAPTION));
        let body: String = panels.collect();
        svg(
            size,
            &format!("The motions of the joint {}", self.name),
            &body,
        )
    }

    /// One picture a panel, to be laid out by the page.
    pub fn pictures(&self) -> Vec<String> {
        let picture = |panel: &Panel| {
            svg(
                (WIDTH, HEIGHT + CAPTION),
                &panel.caption,
                &panel.with_caption(),
            )
        };
        self.panels.iter().map(picture).collect()
    }
}

impl Panel {
    fn with_caption(&self) -> String {
        let colour = if self.forbidden {
            pen::FORBIDDEN
        } else {
            pen::INK
        };
        format!(
            "{}<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"14\" fill=\"{colour}\">{}</text>\n",
            self.elements,
            WIDTH / 2.0,
            HEIGHT + 14.0,
            self.caption
        )
    }
}

fn svg((width, height): (f64, f64), label: &str, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-label=\"{label}\" font-family=\"system-ui, sans-serif\">\n{body}</svg>"
    )
}

/// What moves, and the symbol of its speed: names of a spec are ASCII, so that nothing needs escaping.
fn caption(
    derived: &Derived,
    sampler: &Sampler<'_>,
    direction: Direction,
    freedoms: &[FreedomRow],
) -> String {
    let freedom = |k: usize| freedoms.get(k);
    match direction {
        Direction::Velocity(k) => freedom(k)
            .map(|row| match row.rate_unit.as_str() {
                "" => format!("{}: {}", row.name, row.velocity),
                unit => format!("{}: {}, {unit}", row.name, row.velocity),
            })
            .unwrap_or_default(),
        Direction::Speed(j) => {
            let name = derived.speed_names.get(j).map_or("", String::as_str);
            format!("{name}: allowed")
        }
        Direction::Forbidden(c) => match sampler.only_freedom(c).and_then(freedom) {
            Some(row) => format!("{}: forbidden", row.name),
            None => format!("forbidden by constraint {}", c + 1),
        },
    }
}
