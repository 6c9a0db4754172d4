//! An output folder that touches only what changed.
//!
//! Cargo embeds the folder into the server, and looks at modification times: a file written anew
//! with the same content would compile the server again.

use crate::Result;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder being brought up to date.
pub struct Folder {
    root: PathBuf,
    /// What belongs here, and whether its content is new.
    wanted: BTreeMap<PathBuf, bool>,
}

impl Folder {
    /// Opens a folder, and makes it if need be.
    pub fn open(root: &Path) -> Result<Self> {
        fs::create_dir_all(root)?;
        Ok(Self {
            root: root.to_path_buf(),
            wanted: BTreeMap::new(),
        })
    }

    /// Writes a file unless it has this content already. Returns its path.
    pub fn write(&mut self, name: &str, content: &[u8]) -> Result<PathBuf> {
        let path = self.root.join(name);
        self.write_path(&path, content)?;
        Ok(path)
    }

    /// The same for a full path inside the folder.
    pub fn write_path(&mut self, path: &Path, content: &[u8]) -> Result {
        let is_new = fs::read(path).ok().as_deref() != Some(content);
        if is_new {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::write(path, content)?;
            // Until it is compressed anew, no copy is better than one of another build.
            let packed = super::br_name(path);
            if packed.exists() {
                fs::remove_file(&packed)?;
            }
        }
        self.wanted.insert(path.to_path_buf(), is_new);
        Ok(())
    }

    /// Copies a tree, except the entries of its top level named in `except`.
    pub fn copy_tree(&mut self, source: &Path, except: &[&str]) -> Result {
        for file in walk(source)? {
            let name = file.strip_prefix(source)?;
            if !except.iter().any(|top| name.starts_with(top)) {
                let target = self.root.join(name);
                self.write_path(&target, &fs::read(&file)?)?;
            }
        }
        Ok(())
    }

    /// Marks a file as belonging here and unchanged.
    pub fn keep(&mut self, path: &Path) {
        self.wanted.insert(path.to_path_buf(), false);
    }

    /// The files that belong here so far.
    pub fn files(&self) -> Vec<PathBuf> {
        self.wanted.keys().cloned().collect()
    }

    /// True when the last write changed this file.
    pub fn is_new(&self, path: &Path) -> bool {
        self.wanted.get(path).copied().unwrap_or(false)
    }

    /// Removes the files of earlier builds that do not belong here any more.
    pub fn remove_the_rest(&self) -> Result {
        for file in walk(&self.root)? {
            if !self.wanted.contains_key(&file) {
                fs::remove_file(&file)?;
            }
        }
        Ok(())
    }
}

/// All files below a folder, sorted; none if there is no such folder. Names that begin with a dot
/// are left out, as an editor's spare files are not part of a page.
pub fn walk(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(dir) = open.pop() {
        if !dir.is_dir() {
            continue;
        }
        for entry in fs::read_dir(&dir)? {
            let path = entry?.path();
            let hidden = path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with('.'));
            match (hidden, path.is_dir()) {
                (true, _) => {}
                (false, true) => open.push(path),
                (false, false) => found.push(path),
            }
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_changes_are_written_and_leftovers_go() {
        let root = std::env::temp_dir().join(format!("xtask-files-{}", std::process::id()));
        let mut first = Folder::open(&root).unwrap();
        let a = first.write("css/a.css", b"a").unwrap();
        let old = first.write("old.css", b"old").unwrap();
        assert!(first.is_new(&a));

        let mut second = Folder::open(&root).unwrap();
        second.write("css/a.css", b"a").unwrap();
        assert!(!second.is_new(&a));
        second.remove_the_rest().unwrap();
        assert!(a.exists() && !old.exists());

        let packed = super::super::br_name(&a);
        fs::write(&packed, b"of a").unwrap();
        second.write("css/a.css", b"a").unwrap();
        assert!(packed.exists(), "the file is the same");
        second.write("css/a.css", b"b").unwrap();
        assert!(!packed.exists(), "the copy is of another file");
        fs::remove_dir_all(&root).unwrap();
    }
}
