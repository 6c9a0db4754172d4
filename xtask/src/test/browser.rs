//! The browser of the tests: Chromium with its driver.

use crate::{Result, apt, shell};
use std::env;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::Command;

/// Names under which Chromium goes.
const BROWSERS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Names under which its driver goes.
const DRIVERS: [&str; 2] = ["chromedriver", "chromium.chromedriver"];

/// A browser and the program that drives it.
#[derive(Debug, PartialEq, Eq)]
pub struct Browser {
    binary: PathBuf,
    driver: PathBuf,
}

impl Browser {
    /// Tells a command which browser to use: the wasm test runner and the end-to-end tests read
    /// `CHROMEDRIVER`, the latter also `CHROMIUM`.
    pub fn environment<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command
            .env("CHROMEDRIVER", &self.driver)
            .env("CHROMIUM", &self.binary)
    }
}

/// Finds the browser, and installs it where that is allowed.
pub fn ensure() -> Result<Browser> {
    let look = || {
        find(
            env::var_os("CHROMEDRIVER").as_deref(),
            &shell::search_path(),
        )
    };
    if let Some(browser) = look() {
        println!(
            "{} with {}",
            browser.binary.display(),
            browser.driver.display()
        );
        return Ok(browser);
    }
    apt::install(&["chromium", "chromium-driver"])?;
    look().ok_or_else(|| "Chromium was installed, but it is neither in PATH nor in /usr/bin".into())
}

/// Finds browser and driver in the folders of `path`; a driver that was given wins.
fn find(driver: Option<&OsStr>, path: &OsStr) -> Option<Browser> {
    let driver = driver.map(PathBuf::from).filter(|file| file.is_file());
    Some(Browser {
        binary: shell::find(&BROWSERS, path)?,
        driver: driver.or_else(|| shell::find(&DRIVERS, path))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn both_halves_are_needed() {
        let folder = env::temp_dir().join(format!("xtask-browser-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let put = |name: &str| {
            let file = folder.join(name);
            fs::write(&file, "").unwrap();
            file
        };
        let look = |driver: Option<&OsStr>| find(driver, folder.as_os_str());

        assert_eq!(look(None), None);
        let binary = put("google-chrome");
        assert_eq!(look(None), None, "a browser without its driver is no use");
        let driver = put("chromedriver");
        assert_eq!(
            look(None),
            Some(Browser {
                binary: binary.clone(),
                driver: driver.clone()
            })
        );
        let other = put("another-driver");
        assert_eq!(look(Some(other.as_os_str())).map(|b| b.driver), Some(other));
        assert_eq!(
            look(Some(OsStr::new("absent"))).map(|b| b.driver),
            Some(driver)
        );
        fs::remove_dir_all(&folder).unwrap();
    }
}
