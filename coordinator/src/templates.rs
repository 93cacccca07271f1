//! Models with a study to start from, which `isola new` writes. They are part of the program.

use crate::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// A model with its study, every line of which says what it is for.
#[derive(Debug, Clone, Copy)]
pub struct Template {
    /// Name, as after `--template`.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// Its files: name and contents.
    pub files: &'static [(&'static str, &'static str)],
}

/// A file of a template.
macro_rules! file {
    ($template:literal, $name:literal) => {
        ($name, include_str!(concat!("../templates/", $template, "/", $name)))
    };
}

/// All of them.
pub static TEMPLATES: [Template; 5] = [
    Template {
        name: "duffing",
        about: "one mass on a spring that stiffens",
        files: &[file!("duffing", "model.toml"), file!("duffing", "study.toml")],
    },
    Template {
        name: "stop",
        about: "two masses before a rigid stop",
        files: &[file!("stop", "model.toml"), file!("stop", "study.toml")],
    },
    Template {
        name: "friction",
        about: "two masses, one held by a dry friction joint",
        files: &[file!("friction", "model.toml"), file!("friction", "study.toml")],
    },
    Template {
        name: "absorber",
        about: "a stiffening mass with a nonlinear vibration absorber: it has an isola",
        files: &[file!("absorber", "model.toml"), file!("absorber", "study.toml")],
    },
    Template {
        name: "blade",
        about: "a blade that rubs its casing, with matrices in files",
        files: &[
            file!("blade", "model.toml"),
            file!("blade", "study.toml"),
            file!("blade", "M.mtx"),
            file!("blade", "K.mtx"),
        ],
    },
];

impl Template {
    /// Writes the files into a folder, which is made if it is not there.
    ///
    /// # Errors
    /// A folder with something in it, or one that cannot be written; nothing is written then.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        match fs::read_dir(folder).map(|mut entries| entries.next().is_none()) {
            Ok(true) => {}
            Ok(false) => return refused(folder, "this folder has something in it"),
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) if error.kind() == ErrorKind::NotADirectory => return refused(folder, "this is a file"),
            Err(error) => return Err(Error::io(folder)(error)),
        }
        fs::create_dir_all(folder).map_err(Error::io(folder))?;
        for (name, text) in self.files {
            let file = folder.join(name);
            fs::write(&file, text).map_err(Error::io(file))?;
        }
        Ok(())
    }

    /// What was written, and what to do with it.
    pub fn told(&self, folder: &Path) -> String {
        let files: Vec<&str> = self.files.iter().map(|(name, _)| *name).collect();
        let (folder, mut text) = (folder.display(), String::new());
        let _ = writeln!(text, "{folder}: {} ({})", files.join(", "), self.about);
        for (command, what) in [("check", "what it contains"), ("sweep", "compute it")] {
            let _ = writeln!(text, "  isola {command} {folder}    {what}");
        }
        text
    }
}

fn refused(folder: &Path, why: &str) -> Result<(), Error> {
    Err(Error::Other(format!("{}: {why}; name a new or an empty folder", folder.display())))
}
