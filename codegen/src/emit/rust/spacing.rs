//! Blank lines between items and methods, in modules as well, and comments in bodies: what the printer of tokens leaves out.

use super::comment::with_comments;
use super::lines::joined;
use syn::{Attribute, Expr, File, Item, ItemConst, ItemMod};

/// The file as text, items and methods apart from each other.
pub fn spaced(file: &File) -> String {
    let text = prettyplease::unparse(&file_of(file.attrs.clone(), vec![]));
    text + &items(&file.items, &|_, text| text.to_owned())
}

/// Items apart from each other, each as `place` puts it.
fn items(items: &[Item], place: &dyn Fn(&Item, &str) -> String) -> String {
    let mut text = String::new();
    let mut before: Option<&Item> = None;
    for item in items {
        if before.is_none_or(|before| !belong_together(before, item)) {
            text += "\n";
        }
        let alone = prettyplease::unparse(&file_of(vec![], vec![item.clone()]));
        let alone = match item {
            Item::Impl(_) => apart(&joined(&with_comments(&alone))),
            Item::Fn(_) => joined(&with_comments(&alone)),
            Item::Mod(module) => nested(module),
            Item::Macro(_) => one_call_a_line(&alone),
            Item::Const(constant) if !is_text(constant) => joined(&alone),
            _ => alone,
        };
        text += &place(item, &alone);
        before = Some(item);
    }
    text
}

/// A module with its items apart from each other; one without a body as it is.
fn nested(module: &ItemMod) -> String {
    let mut shell = module.clone();
    let inner = shell
        .content
        .as_mut()
        .map(|(_, items)| std::mem::take(items));
    let text = prettyplease::unparse(&file_of(vec![], vec![Item::Mod(shell)]));
    match inner {
        Some(inner) => {
            let head = text.trim_end().trim_end_matches('}').trim_end();
            format!("{head}\n{}}}\n", items(&inner, &deeper))
        }
        None => text,
    }
}

/// An item's lines one level deeper.
fn deeper(item: &Item, text: &str) -> String {
    let is_text = matches!(item, Item::Const(constant) if is_text(constant));
    let mut moved = String::with_capacity(text.len());
    let mut in_literal = false;
    for line in text.lines() {
        // The lines of a literal are its value, whatever their indent.
        moved += if in_literal || line.is_empty() {
            ""
        } else {
            "    "
        };
        moved += line;
        moved += "\n";
        in_literal |= is_text && line.contains("const ");
    }
    moved
}

/// Whether the constant is a literal, whose lines are its value.
fn is_text(constant: &ItemConst) -> bool {
    matches!(*constant.expr, Expr::Lit(_))
}

fn file_of(attrs: Vec<Attribute>, items: Vec<Item>) -> File {
    File {
        shebang: None,
        frontmatter: None,
        attrs,
        items,
    }
}

/// Imports stand together, and so do declarations of modules.
fn belong_together(a: &Item, b: &Item) -> bool {
    let declares = |item: &Item| matches!(item, Item::Mod(module) if module.content.is_none());
    matches!((a, b), (Item::Use(_), Item::Use(_))) || (declares(a) && declares(b))
}

/// Puts a blank line before each method of an `impl`, its documentation included.
fn apart(text: &str) -> String {
    // Documentation and attributes lead to what they stand above.
    let leads = |line: &str| line.starts_with("    ///") || line.starts_with("    #[");
    let mut spaced = String::with_capacity(text.len());
    let mut before = "";
    for (i, line) in text.lines().enumerate() {
        let starts = leads(line) || line.starts_with("    fn ");
        if starts && i > 1 && !leads(before) {
            spaced += "\n";
        }
        spaced += line;
        spaced += "\n";
        before = line;
    }
    spaced
}

/// Breaks the body of the macro that calls another once for each joint at its calls alone; it holds no literals but numbers.
fn one_call_a_line(text: &str) -> String {
    let mut parts = text.split("$callback !");
    let mut broken = parts.next().unwrap_or_default().trim_end().to_owned();
    for call in parts {
        let (arguments, rest) = call.split_at(call.find(';').map_or(call.len(), |at| at + 1));
        let words: Vec<&str> = arguments.split_whitespace().collect();
        broken += &format!("\n        $callback!{}", words.join(" "));
        if !rest.trim().is_empty() {
            broken += rest;
        }
    }
    broken
}
