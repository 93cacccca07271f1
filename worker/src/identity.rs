//! The worker's name.

use protocol::ids::WorkerId;

/// The name of this machine, as it knows it.
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Host, process and a few random digits: `host-1234-ab12`. The digits tell apart processes of containers, which often
/// share both.
pub fn worker_id() -> WorkerId {
    let host = host_name();
    let random = uuid::Uuid::new_v4().simple().to_string();
    named(&host, std::process::id(), &random[..4])
}

fn named(host: &str, process: u32, random: &str) -> WorkerId {
    // Of `node7.cluster.example.org` the first part is enough for people.
    let host = host.split('.').next().unwrap_or_default();
    let allowed = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    let host: String = host.chars().map(allowed).take(60).collect();
    let host = if host.is_empty() { "worker" } else { &host };
    WorkerId::new(&format!("{host}-{process}-{random}")).expect("every character was checked")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_chunks_of_keys() {
        assert_eq!(named("node7.cluster.example.org", 12, "ab12").as_str(), "node7-12-ab12");
        assert_eq!(named("", 1, "ab12").as_str(), "worker-1-ab12");
        assert_eq!(named("büro/*", 1, "ab12").as_str(), "b-ro---1-ab12");
        assert_eq!(named(&"x".repeat(300), u32::MAX, "ab12").as_str().len(), 60 + 1 + 10 + 1 + 4);
        assert_ne!(worker_id(), worker_id());
    }
}
