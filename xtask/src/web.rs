//! `cargo xtask web`: the page, from Rust to `static/dist`.
//!
//! # The contract for `static/`
//!
//! - Everything in `static/` except `dist/` is copied to `static/dist/` under the same name, so a
//!   link in `index.html` is the same in the source and in the result.
//! - `index.html` holds `<script type="module" src="boot.js"></script>` once. This module writes
//!   `boot.js`, and for each program `NAME.js` and `NAME_bg.wasm`. Other scripts, and inline
//!   scripts, are refused: the server's policy forbids them.
//! - Attributes stand in double quotes and links are relative: `<link rel="stylesheet"
//!   href="css/app.css">`, `<link rel="icon" href="icons/favicon.svg">`. A style sheet may name
//!   files by `url(…)`, but not `@import` another sheet.
//! - Names are fixed, not hashed: the server answers with an `ETag`, so a changed file is noticed
//!   and an unchanged one is not sent again. A `name.br` stands beside each file it makes smaller.
//!
//! # Programs
//!
//! `valvescope` is the page. The others are loaded by the page when they are wanted, through
//! `window.valvescopeProgram(NAME)`, a function of `boot.js` that promises the exports of a program.
//!
//! # The single file
//!
//! `static/dist/valvescope.html` is the same page with style sheets, icon, program and samples
//! inside, for a double click on a laptop where nothing may be installed. Files of
//! `static/samples` are in `<script type="application/json" id="embedded-files">` there, as an
//! object from name (`samples/a.hex`) to base64: a page that wants one looks there before it
//! fetches.

mod compress;
mod files;
mod html;
mod single;
mod slim;

pub use compress::br_name;

use crate::toolchain::{self, WASM};
use crate::{Result, shell};
use std::path::{Path, PathBuf};
use wasm_bindgen_cli_support::Bindgen;

/// What starts the page; its own file, because the server's policy allows no inline script.
const BOOT: &str = include_str!("web/boot.js");

/// The page: its binary in `frontend`, and its name in the browser.
const PAGE: (&str, &str) = ("frontend", "valvescope");

/// The programs that the page loads when they are wanted; binary and name are the same.
const LATER: [&str; 4] = ["diagnostics", "network", "actuator", "hart"];

/// The programs that are compiled with features of their own, without the usual ones: the page does
/// without what they decode, and they do without maps that they never show.
const FEATURED: [(&str, &str); 2] = [("hart", "hart"), ("actuator", "icon,maps")];

/// The code of `shared` is small.
const SMALL: &str = "profile.web.package.shared.opt-level=\"z\"";

/// The files of one program.
pub struct Program {
    /// Its name in the browser.
    pub name: &'static str,
    /// The program.
    pub wasm: PathBuf,
    /// Its glue.
    pub js: PathBuf,
}

/// What a browser loads.
pub struct Bundle {
    /// Before it can show anything.
    pub page: Program,
    /// When it is wanted.
    pub later: Vec<Program>,
}

/// Builds the page into `static/dist`.
pub fn web() -> Result<Bundle> {
    toolchain::ensure_wasm_target()?;
    let source = shell::root().join("static");
    let dist = source.join("dist");
    let binaries = compile()?;

    let index = std::fs::read_to_string(source.join("index.html"))
        .map_err(|error| format!("static/index.html: {error}"))?;
    html::check(&index)?;

    let mut output = files::Folder::open(&dist)?;
    output.copy_tree(&source, &["dist"])?;
    output.write("boot.js", BOOT.as_bytes())?;
    let mut write = |(binary, name): (&str, &'static str)| -> Result<(Program, Glue)> {
        let binary = binaries.join(binary).with_extension("wasm");
        let modules = Glue::generate(&binary, name, Mode::Modules)?;
        let program = Program {
            name,
            js: output.write(&format!("{name}.js"), modules.js.as_bytes())?,
            wasm: output.write(&format!("{name}_bg.wasm"), &modules.wasm)?,
        };
        Ok((program, Glue::generate(&binary, name, Mode::Classic)?))
    };
    let (page, glue) = write(PAGE)?;
    let (mut later, mut later_glue) = (Vec::new(), Vec::new());
    for name in LATER {
        let (program, glue) = write((name, name))?;
        later.push(program);
        later_glue.push((name, glue));
    }
    let single = single::page(&source, &index, &glue, &later_glue)?;
    output.write("valvescope.html", single.as_bytes())?;
    compress::all(&mut output)?;
    output.remove_the_rest()?;
    println!(
        "the page is in {}",
        dist.strip_prefix(shell::root()).unwrap_or(&dist).display()
    );
    Ok(Bundle { page, later })
}

/// Compiles all programs, and returns the folder of the raw wasm files.
///
/// The page decodes captures of any size, so the code of `shared` is fast there (see the profile);
/// the programs that come later decode one object at a time, so theirs is small.
fn compile() -> Result<PathBuf> {
    let args = [
        "build",
        "-p",
        "frontend",
        "--profile",
        "web",
        "--target",
        WASM,
    ];
    let mut page = shell::cargo(args);
    page.args(["--bin", PAGE.0]);
    let mut later = shell::cargo(args);
    later.args(["--config", SMALL]);
    let plain = |binary: &&str| FEATURED.iter().all(|(name, _)| name != binary);
    for binary in LATER.into_iter().filter(plain) {
        later.args(["--bin", binary]);
    }
    let featured = FEATURED.map(|(binary, features)| {
        let mut command = shell::cargo(args);
        command.args(["--config", SMALL, "--bin", binary, "--features", features]);
        command.arg("--no-default-features");
        command
    });
    for mut command in [page, later].into_iter().chain(featured) {
        shell::run(command.env("CARGO_ENCODED_RUSTFLAGS", flags()))?;
    }
    Ok(shell::target_dir().join(WASM).join("web"))
}

/// The flags of `.cargo/config.toml`, which this variable replaces, and short names for the places
/// of sources: a panic names its place, and the folders of the building machine are nobody's
/// business.
fn flags() -> String {
    let home = std::env::var_os("CARGO_HOME").map_or_else(
        || std::env::home_dir().unwrap_or_default().join(".cargo"),
        PathBuf::from,
    );
    let crates = std::fs::read_dir(home.join("registry/src"));
    let crates = crates.into_iter().flatten().flatten().map(|e| e.path());
    // Snapshots are hashed by code that is short instead of fast.
    let mut flags = vec![
        "--cfg=erase_components".to_owned(),
        "--cfg=sha2_backend_soft=\"compact\"".to_owned(),
    ];
    // Of the names that fit, rustc takes the last.
    flags.push(remap(shell::root(), "valvescope"));
    flags.push(remap(&home, "cargo"));
    flags.extend(crates.map(|folder| remap(&folder, "crates")));
    flags.join("\u{1f}")
}

fn remap(folder: &Path, name: &str) -> String {
    format!("--remap-path-prefix={}={name}", folder.display())
}

/// How the glue is loaded.
#[derive(Clone, Copy)]
enum Mode {
    /// As a module, by `boot.js`.
    Modules,
    /// As a classic script inside the single file, where modules cannot be imported.
    Classic,
}

/// The program with the JavaScript that binds it to the browser.
struct Glue {
    js: String,
    wasm: Vec<u8>,
}

impl Glue {
    /// Runs wasm-bindgen, whose version is locked to that of the library.
    fn generate(program: &Path, name: &str, mode: Mode) -> Result<Self> {
        let mut bindgen = Bindgen::new();
        bindgen
            .input_path(program)
            .out_name(name)
            .typescript(false)
            // Names of functions are a third of the file; a panic still tells its place.
            .remove_name_section(true)
            .remove_producers_section(true)
            .omit_default_module_path(false);
        match mode {
            Mode::Modules => bindgen.web(true),
            // Classic scripts share one space of names.
            Mode::Classic => bindgen
                .no_modules(true)
                .and_then(|bindgen| bindgen.no_modules_global(name)),
        }
        .map_err(|error| format!("wasm-bindgen: {error:?}"))?;
        let mut output = bindgen
            .generate_output()
            .map_err(|error| format!("wasm-bindgen: {error:?}"))?;
        if output.snippets().values().any(|files| !files.is_empty())
            || !output.local_modules().is_empty()
        {
            return Err("a dependency of the page brings a JavaScript snippet; \
                 the single file cannot hold it, so find another way"
                .into());
        }
        let js = output.js().to_owned();
        let js = slim::slim(output.wasm_mut(), &js)?;
        Ok(Self {
            js,
            wasm: output.wasm_mut().emit_wasm(),
        })
    }
}
