//! Takes out of a program what nobody calls, and shortens what nobody reads.
//!
//! A dependency of the view library exports three classes for streams that this page never makes;
//! an export keeps its code alive. The names of imports and closures end with sixteen digits that no
//! compressor can shorten, and stand in both files. Together that is a twentieth of the page.

use crate::Result;
use std::collections::{BTreeMap, BTreeSet};
use walrus::{ImportKind, Module};

/// Beginnings of exports that the page has no use for.
const UNUSED: [&str; 2] = ["intounderlying", "__wbg_intounderlying"];

/// The name of the classes that belong to them.
const UNUSED_CLASS: &str = "IntoUnderlying";

/// Slims a program and its glue; gives the new glue.
pub fn slim(wasm: &mut Module, js: &str) -> Result<String> {
    remove_unused(wasm);
    let names = rename(wasm);
    let kept: BTreeSet<&str> = names.keys().map(String::as_str).collect();
    let js = without_comments(js);
    let js = without_classes(&js)?;
    let js = without_imports(&js, &kept);
    Ok(renamed(&js, &names))
}

fn remove_unused(wasm: &mut Module) {
    let unused: Vec<_> = wasm
        .exports
        .iter()
        .filter(|export| UNUSED.iter().any(|name| export.name.starts_with(name)))
        .map(walrus::Export::id)
        .collect();
    for id in unused {
        wasm.exports.delete(id);
    }
    walrus::passes::gc::run(wasm);
}

/// Gives every imported function and every closure a short name; old names to new ones.
fn rename(wasm: &mut Module) -> BTreeMap<String, String> {
    let mut names = BTreeMap::new();
    for import in wasm.imports.iter_mut() {
        if matches!(import.kind, ImportKind::Function(_)) {
            let short = format!("i{}", names.len());
            names.insert(std::mem::replace(&mut import.name, short.clone()), short);
        }
    }
    for export in wasm.exports.iter_mut() {
        if export.name.starts_with("wasm_bindgen__convert__") {
            let short = format!("c{}", names.len());
            names.insert(std::mem::replace(&mut export.name, short.clone()), short);
        }
    }
    names
}

/// Drops the comments that describe types, empty lines and indentation.
fn without_comments(js: &str) -> String {
    let mut out = String::with_capacity(js.len());
    let mut inside = false;
    for line in js.lines().map(str::trim) {
        inside |= line.starts_with("/**");
        if !inside && !line.is_empty() {
            out.push_str(line);
            out.push('\n');
        }
        inside &= !line.ends_with("*/");
    }
    out
}

/// Drops the classes of the unused exports and what is said about them.
fn without_classes(js: &str) -> Result<String> {
    let mut out = String::with_capacity(js.len());
    // Braces that are open inside what is dropped; a statement ends with a semicolon outside of any.
    let mut open: Option<i32> = None;
    for line in js.lines() {
        let begins = open.is_none() && line.contains(UNUSED_CLASS);
        if !begins && open.is_none() {
            out.push_str(line);
            out.push('\n');
            continue;
        }
        let depth = open.unwrap_or(0) + braces(line);
        let is_class = begins && line.contains("class ");
        let over = depth == 0 && !is_class && (line.ends_with(';') || line == "}");
        open = (!over).then_some(depth);
    }
    if open.is_some() || out.contains(UNUSED_CLASS) {
        return Err("the glue of a program has another form than expected; \
             see xtask/src/web/slim.rs"
            .into());
    }
    Ok(out)
}

fn braces(line: &str) -> i32 {
    line.chars().fold(0, |depth, c| match c {
        '{' => depth + 1,
        '}' => depth - 1,
        _ => depth,
    })
}

/// Drops the imports that are no longer imported: entries `name: function…` of the list.
fn without_imports(js: &str, kept: &BTreeSet<&str>) -> String {
    let mut out = String::with_capacity(js.len());
    let mut open: Option<i32> = None;
    for line in js.lines() {
        let unused = line
            .split_once(": function(")
            .is_some_and(|(name, _)| name.starts_with("__wb") && !kept.contains(name));
        if !unused && open.is_none() {
            out.push_str(line);
            out.push('\n');
            continue;
        }
        let depth = open.unwrap_or(0) + braces(line);
        open = (depth > 0).then_some(depth);
    }
    out
}

/// Replaces whole names.
fn renamed(js: &str, names: &BTreeMap<String, String>) -> String {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '$';
    let mut out = String::with_capacity(js.len());
    let mut rest = js;
    while !rest.is_empty() {
        let word = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        let (name, tail) = rest.split_at(word);
        out.push_str(names.get(name).map_or(name, String::as_str));
        let between = tail.find(is_part).unwrap_or(tail.len());
        let (gap, tail) = tail.split_at(between);
        out.push_str(gap);
        rest = tail;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLUE: &str = "\
export class IntoUnderlyingSink {
free() {
if (this.a) { return 1; }
}
}
if (Symbol.dispose) IntoUnderlyingSink.prototype[Symbol.dispose] = IntoUnderlyingSink.prototype.free;

export class Handle {
    /**
 * Says it.
 */
free() {
wasm.wasm_bindgen__convert__x_h12(1);
}
}
const IntoUnderlyingSinkFinalization = (typeof F === 'undefined')
? { register: () => {}, unregister: () => {} }
: new F(ptr => wasm.free(ptr, 1));
return {
__wbg_a_12: function(arg0) {
arg0();
},
__wbg_ab_12: function() { return handleError(function (arg0) {
if (arg0) { arg0(); }
}, arguments); },
};
";

    #[test]
    fn unused_parts_go_and_the_rest_stays() {
        let js = without_classes(&without_comments(GLUE)).unwrap();
        let js = without_imports(&js, &BTreeSet::from(["__wbg_a_12"]));
        let names = BTreeMap::from([
            ("__wbg_a_12".into(), "i0".into()),
            ("wasm_bindgen__convert__x_h12".into(), "c1".into()),
        ]);
        let expected = "\
export class Handle {
free() {
wasm.c1(1);
}
}
return {
i0: function(arg0) {
arg0();
},
};
";
        assert_eq!(renamed(&js, &names), expected);
    }

    #[test]
    fn another_form_is_noticed() {
        let js = "export class IntoUnderlyingSink {\nfree() {\n";
        assert!(without_classes(js).is_err());
    }
}
