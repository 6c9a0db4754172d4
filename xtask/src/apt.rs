//! Installing what the tests need, where that is allowed.

use crate::{Result, shell};

/// What stands before `apt-get` on this machine: nothing for root, `sudo -n` where that asks no
/// questions, and `None` where this program may not install anything.
fn prefix(has_apt: bool, is_root: bool, may_sudo: bool) -> Option<&'static [&'static str]> {
    match (has_apt, is_root, may_sudo) {
        (true, true, _) => Some(&[]),
        (true, false, true) => Some(&["sudo", "-n"]),
        _ => None,
    }
}

/// Installs Debian packages, or says what to install by hand.
pub fn install(packages: &[&str]) -> Result {
    let by_hand = || {
        format!(
            "please install: {} (on Debian: apt-get install {0})",
            packages.join(" ")
        )
    };
    let has_apt = shell::succeeds(&mut shell::program("apt-get", ["--version"]));
    let is_root =
        shell::capture(&mut shell::program("id", ["-u"])).is_ok_and(|id| id.trim() == "0");
    let may_sudo = !is_root && shell::succeeds(&mut shell::program("sudo", ["-n", "true"]));
    let Some(prefix) = prefix(has_apt, is_root, may_sudo) else {
        return Err(by_hand().into());
    };
    println!("installing by apt: {}", packages.join(" "));
    apt_get(prefix, &["update", "-qq"]).map_err(|error| format!("{error}; {}", by_hand()))?;
    let mut args = vec!["install", "-y", "-qq", "--no-install-recommends"];
    args.extend(packages);
    apt_get(prefix, &args).map_err(|error| format!("{error}; {}", by_hand()).into())
}

fn apt_get(prefix: &[&str], args: &[&str]) -> Result {
    let words: Vec<&str> = prefix
        .iter()
        .chain(&["apt-get"])
        .chain(args)
        .copied()
        .collect();
    let (first, rest) = words.split_first().ok_or("no command")?;
    let mut command = shell::program(first, rest);
    // Debian asks questions of people only; the variable is lost under sudo, which is harmless.
    command.env("DEBIAN_FRONTEND", "noninteractive");
    // What it unpacks is of no interest; why it fails is on its standard error.
    shell::run(command.stdout(std::process::Stdio::null()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apt_is_used_only_where_it_may() {
        let none: &[&str] = &[];
        assert_eq!(prefix(true, true, false), Some(none));
        assert_eq!(prefix(true, false, true), Some(["sudo", "-n"].as_slice()));
        assert_eq!(prefix(true, false, false), None);
        assert_eq!(prefix(false, true, true), None);
    }
}
