//! A function in which like bodies are looped over.

use super::lines::{Formula, Line, Loop, Place, Row};
use super::lower::{Lowering, partners};
use super::straight::{given, heading};
use super::{Function, Lowered};
use crate::alike::{Plan, Read, Trigonometry};
use crate::graph::{Graph, Operation, Operations};
use hamel_codegen::formula::names::NameSet;
use rustc_hash::FxHashMap;

/// The lines of a function by its plan.
pub fn lowered(
    function: &Function,
    plan: &Plan,
    bodies: &[String],
    names: &mut NameSet,
) -> Lowered {
    let graph = &function.graph;
    let uses = graph.uses(&function.outputs);
    let mut writer = Writer {
        function,
        plan,
        partners: partners(graph, &uses),
        uses,
        bodies,
        names,
        known: FxHashMap::default(),
        lines: vec![],
    };
    writer.angles();
    writer.given_results();
    for group in &plan.groups {
        match group.as_slice() {
            [block] => writer.single(*block),
            group => writer.several(group),
        }
    }
    Lowered {
        lines: writer.lines,
        arrays: plan.arrays.clone(),
        outputs: None,
    }
}

struct Writer<'a> {
    function: &'a Function,
    plan: &'a Plan,
    uses: Vec<u32>,
    partners: FxHashMap<u32, u32>,
    bodies: &'a [String],
    names: &'a mut NameSet,
    /// What stands outside of loops for what blocks leave.
    known: FxHashMap<u32, Formula>,
    lines: Vec<Line>,
}

impl Writer<'_> {
    fn graph(&self) -> &Graph {
        &self.function.graph
    }

    fn angles(&mut self) {
        let blocks = &self.plan.blocks;
        if blocks.angles.is_empty() {
            return;
        }
        let mut operations = Operations::default();
        for &node in blocks.trigonometry.keys() {
            operations.add(&self.graph().nodes[node as usize].operation);
        }
        let angles = blocks
            .angles
            .iter()
            .map(|&angle| given(self.graph(), angle));
        let angles = Line::Angles(angles.collect());
        self.lines.push(Line::Heading(heading(operations)));
        self.lines.push(angles);
    }

    /// Results that no block computes.
    fn given_results(&mut self) {
        for (place, output) in self.function.outputs.iter().enumerate() {
            if self.plan.blocks.home.contains_key(&output.node) {
                continue;
            }
            let formula = outside(self.graph(), self.plan, output.node);
            let formula = match output.negative {
                true => formula.negated(),
                false => formula,
            };
            self.lines.push(Line::Result(Place::Known(place), formula));
        }
    }

    /// A block that stands alone.
    fn single(&mut self, block: usize) {
        let (plan, graph) = (self.plan, &self.function.graph);
        let known = &self.known;
        let outside = |node: u32| {
            let left = known.get(&node).cloned();
            left.unwrap_or_else(|| outside(graph, plan, node))
        };
        let body = |section: u32| {
            self.bodies
                .get(section as usize)
                .cloned()
                .unwrap_or_default()
        };
        let interface = &plan.interfaces[block];
        let mut lowering = Lowering {
            graph,
            uses: &self.uses,
            partners: &self.partners,
            bodies: &body,
            left: plan.blocks.blocks[block].outputs.iter().copied().collect(),
            crossings: FxHashMap::default(),
            outside: &outside,
            names: self.names,
            formulas: FxHashMap::default(),
            lines: vec![],
        };
        lowering.run(&plan.blocks.blocks[block].nodes);
        let outputs = &plan.blocks.blocks[block].outputs;
        let left: Vec<Formula> = outputs
            .iter()
            .map(|&node| lowering.read(node.into()))
            .collect();
        let results: Vec<Line> = interface
            .results
            .iter()
            .map(|&(place, value)| Line::Result(Place::Known(place), lowering.read(value)))
            .collect();
        self.lines.extend(lowering.lines);
        if let Some(row) = plan.rows[block] {
            self.lines.push(Line::Row(Row {
                place: Place::Known(row),
                values: left.clone(),
            }));
        }
        self.known.extend(outputs.iter().copied().zip(left));
        self.lines.extend(results);
    }

    /// Like blocks.
    fn several(&mut self, group: &[usize]) {
        let (plan, graph) = (self.plan, &self.function.graph);
        let mut tables = Tables::new(group.len());
        let first = group[0];
        let block = &plan.blocks.blocks[first];
        let sources = self.sources(group, &mut tables);
        let inside = Inside::new(graph, plan, group, &sources, &mut tables);
        let body = |_| "each".to_owned();
        let mut lowering = Lowering {
            graph,
            uses: &self.uses,
            partners: &self.partners,
            bodies: &body,
            left: block.outputs.iter().copied().collect(),
            crossings: FxHashMap::default(),
            outside: &|node| inside.formula(node),
            names: self.names,
            formulas: FxHashMap::default(),
            lines: vec![],
        };
        lowering.run(&block.nodes);
        let values: Vec<Formula> = block
            .outputs
            .iter()
            .map(|&node| lowering.read(node.into()))
            .collect();
        let results = plan.interfaces[first].results.iter().enumerate();
        let results: Vec<(Place, Formula)> = results
            .map(|(i, &(_, value))| (tables.result(plan, group, i), lowering.read(value)))
            .collect();
        let mut lines = lowering.lines;
        let row = (!values.is_empty()).then(|| {
            let rows = group.iter().map(|&block| row_of(plan, block));
            let place = tables.place(rows.collect());
            Line::Row(Row { place, values })
        });
        let results = results.into_iter();
        lines.extend(results.map(|(place, formula)| Line::Result(place, formula)));
        // Last: in Rust, the rows that results read are borrowed until then.
        lines.extend(row);
        self.leave_rows(group);
        let name = self.names.claim("like");
        self.lines.push(Line::Loop(Loop {
            name,
            bodies: group.iter().map(|&block| self.body(block)).collect(),
            places: tables.places,
            numbers: tables.numbers,
            sources,
            lines,
        }));
    }

    /// Lets what stands outside of loops find what the blocks left.
    fn leave_rows(&mut self, group: &[usize]) {
        for &block in group {
            let outputs = &self.plan.blocks.blocks[block].outputs;
            if outputs.is_empty() {
                continue;
            }
            let row = row_of(self.plan, block);
            let entries = outputs.iter().enumerate();
            let formulas =
                entries.map(|(entry, &node)| (node, Formula::Row(outputs.len(), row, entry)));
            self.known.extend(formulas);
        }
    }

    fn body(&self, block: usize) -> String {
        let section = self.plan.blocks.blocks[block].section as usize;
        self.bodies.get(section).cloned().unwrap_or_default()
    }

    /// What the blocks of a group read of others: names tell whose it is.
    fn sources(&mut self, group: &[usize], tables: &mut Tables) -> Vec<(String, usize, Place)> {
        let plan = self.plan;
        let own = plan.blocks.blocks[group[0]].section;
        let sources = &plan.interfaces[group[0]].sources;
        let source = |(ordinal, &block): (usize, &usize)| {
            let source = &plan.blocks.blocks[block];
            let name = match source.section.cmp(&own) {
                std::cmp::Ordering::Less => "parent",
                std::cmp::Ordering::Equal => "own",
                std::cmp::Ordering::Greater => "child",
            };
            let rows = group
                .iter()
                .map(|&member| row_of(plan, plan.interfaces[member].sources[ordinal]));
            let place = tables.place(rows.collect());
            (self.names.claim(name), source.outputs.len(), place)
        };
        sources.iter().enumerate().map(source).collect()
    }
}

/// The row in which a block leaves its values.
fn row_of(plan: &Plan, block: usize) -> usize {
    plan.rows[block].expect("a block that leaves values has a row")
}

/// What stands for a node that no block computes, outside of loops.
fn outside(graph: &Graph, plan: &Plan, node: u32) -> Formula {
    match plan.blocks.trigonometry.get(&node) {
        Some(&Trigonometry { is_sine, angle }) => {
            let array = if is_sine { Read::Sines } else { Read::Cosines };
            Formula::Input(array, Place::Known(angle))
        }
        None => given(graph, node),
    }
}

/// What stands in a loop for what its first block reads.
struct Inside<'a> {
    graph: &'a Graph,
    plan: &'a Plan,
    block: usize,
    sources: &'a [(String, usize, Place)],
    arrays: Vec<(Read, usize, Place)>,
    numbers: FxHashMap<u32, Formula>,
}

impl<'a> Inside<'a> {
    fn new(
        graph: &'a Graph,
        plan: &'a Plan,
        group: &[usize],
        sources: &'a [(String, usize, Place)],
        tables: &mut Tables,
    ) -> Self {
        let first = &plan.interfaces[group[0]];
        let arrays = first.arrays.iter().enumerate().map(|(i, &(array, start))| {
            let starts = group
                .iter()
                .map(|&block| plan.interfaces[block].arrays[i].1);
            (array, start, tables.place(starts.collect()))
        });
        let arrays = arrays.collect();
        let numbers = first.numbers.iter().enumerate().map(|(i, &node)| {
            let column = group
                .iter()
                .map(|&block| number(graph, plan.interfaces[block].numbers[i]));
            (node, tables.number(column.collect()))
        });
        Self {
            graph,
            plan,
            block: group[0],
            sources,
            arrays,
            numbers: numbers.collect(),
        }
    }

    fn formula(&self, node: u32) -> Formula {
        if let Some(number) = self.numbers.get(&node) {
            return number.clone();
        }
        if let Some(&home) = self.plan.blocks.home.get(&node) {
            return self.source(home, node);
        }
        match outside(self.graph, self.plan, node) {
            Formula::Input(array, Place::Known(entry)) => self.entry(array, entry),
            other => other,
        }
    }

    fn source(&self, home: usize, node: u32) -> Formula {
        let sources = &self.plan.interfaces[self.block].sources;
        let ordinal = sources.iter().position(|&source| source == home);
        let entry = self.plan.blocks.blocks[home].outputs.binary_search(&node);
        match (ordinal.and_then(|ordinal| self.sources.get(ordinal)), entry) {
            (Some((name, ..)), Ok(entry)) => Formula::Source(name.clone(), entry),
            // Interfaces list all that a block reads.
            _ => Formula::Number(f64::NAN),
        }
    }

    fn entry(&self, array: Read, entry: usize) -> Formula {
        let known = self.arrays.iter().find(|(known, ..)| *known == array);
        let place = known.map(|&(_, first, place)| place.plus(entry as i64 - first as i64));
        Formula::Input(array, place.unwrap_or(Place::Known(entry)))
    }
}

fn number(graph: &Graph, node: u32) -> f64 {
    match graph.nodes[node as usize].operation {
        Operation::Constant(bits) => f64::from_bits(bits),
        _ => f64::NAN,
    }
}

/// Tables of a loop, one row a turn.
struct Tables {
    places: Vec<Vec<usize>>,
    numbers: Vec<Vec<f64>>,
}

impl Tables {
    fn new(turns: usize) -> Self {
        Self {
            places: vec![vec![]; turns],
            numbers: vec![vec![]; turns],
        }
    }

    /// An index that takes these values: by a rule where there is one, else a column.
    fn place(&mut self, values: Vec<usize>) -> Place {
        let signed: Vec<i64> = values.iter().map(|&value| value as i64).collect();
        let (start, step) = (
            signed[0],
            signed.get(1).map_or(0, |second| second - signed[0]),
        );
        if signed.windows(2).all(|pair| pair[1] - pair[0] == step) {
            return match step {
                0 => Place::Known(values[0]),
                step => Place::Along { start, step },
            };
        }
        Place::Listed {
            column: column(&mut self.places, &values),
            offset: 0,
        }
    }

    /// The place of a result that like blocks have: so far from that of an earlier result where it is as far in all of them.
    fn result(&mut self, plan: &Plan, group: &[usize], result: usize) -> Place {
        let places = |result: usize| -> Vec<usize> {
            let blocks = group.iter();
            blocks
                .map(|&block| plan.interfaces[block].results[result].0)
                .collect()
        };
        let own = places(result);
        for earlier in 0..result {
            let others = places(earlier);
            let by = own[0] as i64 - others[0] as i64;
            let mut both = own.iter().zip(&others);
            if both.all(|(&own, &other)| own as i64 - other as i64 == by) {
                return self.place(others).plus(by);
            }
        }
        self.place(own)
    }

    /// A number that takes these values.
    fn number(&mut self, values: Vec<f64>) -> Formula {
        match values.iter().all(|value| *value == values[0]) {
            true => Formula::Number(values[0]),
            false => Formula::Column(column(&mut self.numbers, &values)),
        }
    }
}

/// The column of a table that holds `values`, made where there is none.
fn column<T: Copy + PartialEq>(table: &mut [Vec<T>], values: &[T]) -> usize {
    let width = table[0].len();
    let holds = |column: &usize| {
        table
            .iter()
            .zip(values)
            .all(|(row, value)| row[*column] == *value)
    };
    if let Some(known) = (0..width).find(holds) {
        return known;
    }
    for (row, &value) in table.iter_mut().zip(values) {
        row.push(value);
    }
    width
}
