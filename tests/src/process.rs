//! A child process whose output is kept, and which ends with its owner.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// How long a program may take to say that it is ready.
const START: Duration = Duration::from_secs(20);

/// A running program. Dropping it kills it.
#[derive(Debug)]
pub struct Process {
    child: Child,
    output: Arc<Mutex<Vec<String>>>,
}

impl Process {
    /// Starts a program and waits until `ready` finds something in a line of its output.
    ///
    /// # Panics
    ///
    /// If the program cannot be started, or if it ends or stays silent. The panic shows what it
    /// said, and `advice`.
    pub fn start<T>(
        command: &mut Command,
        advice: &str,
        mut ready: impl FnMut(&str) -> Option<T>,
    ) -> (Self, T) {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("cannot start {command:?}: {error}; {advice}"));
        let output = Arc::new(Mutex::new(Vec::new()));
        let (sender, lines) = channel();
        let streams: [Option<Box<dyn Read + Send>>; 2] = [
            child.stdout.take().map(|s| Box::new(s) as _),
            child.stderr.take().map(|s| Box::new(s) as _),
        ];
        for stream in streams.into_iter().flatten() {
            let (output, sender) = (Arc::clone(&output), sender.clone());
            // Reads to the end, so that the program never blocks on a full pipe.
            thread::spawn(move || {
                for line in BufReader::new(stream).lines().map_while(Result::ok) {
                    output
                        .lock()
                        .expect("no panic while locked")
                        .push(line.clone());
                    let _ = sender.send(line); // nobody listens once the program is ready
                }
            });
        }
        drop(sender);
        let process = Self { child, output };
        match first(&lines, &mut ready) {
            Ok(found) => (process, found),
            Err(why) => panic!(
                "{command:?} {why}; {advice}. It said:\n{}",
                process.output().join("\n")
            ),
        }
    }

    /// What the program has written so far, line by line.
    ///
    /// # Panics
    ///
    /// Never: the lock is held for no longer than a copy.
    #[must_use]
    pub fn output(&self) -> Vec<String> {
        self.output.lock().expect("no panic while locked").clone()
    }

    /// The id of the process, for signals.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the program to end by itself. False when it did not within `limit`.
    pub fn ends_within(&mut self, limit: Duration) -> bool {
        let end = Instant::now() + limit;
        while Instant::now() < end {
            if matches!(self.child.try_wait(), Ok(Some(_))) {
                return true;
            }
            thread::sleep(Duration::from_millis(10));
        }
        false
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill(); // an error means that it has ended
        let _ = self.child.wait();
    }
}

/// The first thing that `ready` finds.
fn first<T>(
    lines: &Receiver<String>,
    ready: &mut impl FnMut(&str) -> Option<T>,
) -> Result<T, &'static str> {
    let end = Instant::now() + START;
    loop {
        match lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
            Ok(line) => {
                if let Some(found) = ready(&line) {
                    return Ok(found);
                }
            }
            Err(RecvTimeoutError::Timeout) => return Err("did not say that it is ready"),
            Err(RecvTimeoutError::Disconnected) => return Err("ended"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_is_awaited_and_kept() {
        let mut shell = Command::new("sh");
        shell.args(["-c", "echo one; echo port 7 >&2; sleep 60"]);
        let find = |line: &str| line.strip_prefix("port ")?.parse::<u16>().ok();
        let (mut process, port) = Process::start(&mut shell, "install a shell", find);
        assert_eq!(port, 7);
        assert!(!process.ends_within(Duration::from_millis(20)));
    }

    #[test]
    #[should_panic(expected = "ended; do this instead. It said:\nno")]
    fn a_program_that_ends_is_reported() {
        let mut shell = Command::new("sh");
        let _ = Process::start(shell.args(["-c", "echo no"]), "do this instead", |_| {
            None::<()>
        });
    }
}
