//! `valvescope dop`: the registers of a diagnostic object to values.

mod text;

use super::{MISUSE, path_or_stdin, refuse};
use clap::ValueEnum;
use shared::dop::input::{self, Form};
use shared::dop::{ObjectRead, Profile, Request, export};
use std::fs::{self, File};
use std::io::{self, ErrorKind, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// More text than this is no response: 512 registers have room in a fraction of it.
const LONGEST: u64 = 1024 * 1024;

/// Decode the registers of a diagnostic object.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The registers of the response; `-` or nothing means standard input.
    ///
    /// Hexadecimal in any usual writing, decimal, bytes, responses of a bus, or a table with a
    /// column of values.
    file: Option<PathBuf>,
    /// The word that was written to the request register, such as 0x1001.
    ///
    /// Without it, the number of registers tells which objects it can be.
    #[arg(long, value_parser = request)]
    request: Option<Request>,
    /// The profile of the site: what the manual leaves open.
    #[arg(long)]
    profile: Option<PathBuf>,
    /// How the registers are written.
    #[arg(long = "as", value_enum, default_value_t = FormArg::Auto)]
    form: FormArg,
    /// The status was Error, so the first register is an error code.
    #[arg(long)]
    error: bool,
    /// What to print: readable text, or one JSON object a line.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Writings that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FormArg {
    /// Whichever fits.
    Auto,
    /// Hexadecimal registers.
    Hex,
    /// Decimal registers.
    Decimal,
    /// Hexadecimal bytes.
    Bytes,
    /// Responses of a bus in hexadecimal.
    Frames,
    /// A table with a column of values.
    Table,
}

impl FormArg {
    fn form(self) -> Option<Form> {
        match self {
            Self::Auto => None,
            Self::Hex => Some(Form::Hex),
            Self::Decimal => Some(Form::Decimal),
            Self::Bytes => Some(Form::Bytes),
            Self::Frames => Some(Form::Frames),
            Self::Table => Some(Form::Table),
        }
    }
}

/// Forms of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// A request word: hexadecimal with `0x`, or decimal.
fn request(text: &str) -> Result<Request, String> {
    let word = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u16::from_str_radix(digits, 16),
        None => text.parse(),
    };
    word.map(Request::from_word)
        .map_err(|_| format!("`{text}` is no request word; write it as 0x1001 or in decimal"))
}

/// Decodes what the arguments name. 0: all sound; 1: errors found, or the object is not clear;
/// 2: could not be read.
pub(super) fn run(args: &Args) -> ExitCode {
    let profile = match args.profile.as_deref().map(profile).transpose() {
        Ok(profile) => profile.unwrap_or_default(),
        Err(why) => return refuse(why),
    };
    let text = match read(args) {
        Ok(text) => text,
        Err(why) => return refuse(why),
    };
    let mut out = String::new();
    let colour = args.format == Format::Text && io::stdout().is_terminal();
    let sound = match decode(args, &text, &profile, colour, &mut out) {
        Ok(sound) => sound,
        Err(error) => return refuse(error),
    };
    match io::stdout().lock().write_all(out.as_bytes()) {
        Ok(()) => ExitCode::from(u8::from(!sound)),
        // Whoever read our output has seen enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => ExitCode::from(u8::from(!sound)),
        Err(error) => {
            eprintln!("valvescope: can't print the object: {error}");
            ExitCode::from(MISUSE)
        }
    }
}

/// The profile in a file, or all that is wrong with it.
fn profile(path: &Path) -> Result<Profile, String> {
    let name = path.display();
    let text = fs::read_to_string(path).map_err(|error| format!("can't read {name}: {error}"))?;
    Profile::from_json(&text).map_err(|problems| {
        let problems: Vec<String> = problems.iter().map(|p| format!("{name}: {p}")).collect();
        format!("the profile can't be used\n{}", problems.join("\n"))
    })
}

/// The text of the input; bytes that are no characters become marks that no register has.
fn read(args: &Args) -> Result<String, String> {
    let mut bytes = Vec::new();
    let source: Box<dyn Read> = match path_or_stdin(args.file.as_ref()) {
        None => Box::new(io::stdin().lock()),
        Some(path) => Box::new(
            File::open(path).map_err(|error| format!("can't open {}: {error}", path.display()))?,
        ),
    };
    source
        .take(LONGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| format!("can't read the registers: {error}"))?;
    if bytes.len() as u64 > LONGEST {
        return Err("more than 1 MiB is no response of at most 512 registers".to_owned());
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Writes everything; true if nothing is wrong.
fn decode(
    args: &Args,
    text: &str,
    profile: &Profile,
    colour: bool,
    out: &mut String,
) -> Result<bool, std::fmt::Error> {
    let json = args.format == Format::Json;
    let input = input::read(text, args.form.form());
    let mut sound = input.problems.is_empty();
    if json {
        for problem in &input.problems {
            text::write_input_json(out, problem)?;
        }
    } else {
        text::write_input(out, colour, &input)?;
    }
    let request = match args.request {
        Some(request) => request,
        None => {
            let found: Vec<_> = ObjectRead::candidates(input.words.len()).collect();
            let request = text::only(&found);
            if json {
                export::write_candidates(out, &input.words)?;
                out.push('\n');
            } else {
                text::write_candidates(out, &found, &input.words, profile)?;
            }
            let Some(request) = request else {
                return Ok(false);
            };
            request
        }
    };
    let read = if args.error {
        ObjectRead::error(request, &input.words, profile)
    } else {
        ObjectRead::read(request, &input.words, profile)
    };
    sound &= read.decoded.is_ok();
    if json {
        export::write_object(out, 0, &read)?;
        out.push('\n');
    } else {
        text::write_object(out, colour, &read)?;
    }
    Ok(sound)
}

#[cfg(test)]
mod tests;
