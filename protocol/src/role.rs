//! Roles that certificates give: what a coordinator, an operator, a worker and a viewer may do on the bus.
//!
//! Zenoh's access control drops what is not allowed without a word. Whoever holds a certificate knows its role, and is told before
//! anything is asked that would be dropped.

use std::fmt;

/// What somebody is, by the common name of the certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Reads: manifest, model, status, results.
    Viewer,
    /// Reads, takes tasks and hands in results.
    Worker,
    /// Reads, and gives orders: cancel, retry.
    Operator,
    /// Serves the run, and may do all of that.
    Coordinator,
}

impl Role {
    /// All of them, the one that may do most first.
    pub const ALL: [Self; 4] = [Self::Coordinator, Self::Operator, Self::Worker, Self::Viewer];

    /// As people say it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coordinator => "coordinator",
            Self::Operator => "operator",
            Self::Worker => "worker",
            Self::Viewer => "viewer",
        }
    }

    /// The same with an article.
    pub fn with_article(self) -> &'static str {
        match self {
            Self::Coordinator => "a coordinator",
            Self::Operator => "an operator",
            Self::Worker => "a worker",
            Self::Viewer => "a viewer",
        }
    }

    /// Common name of its certificates.
    pub fn common_name(self) -> &'static str {
        match self {
            Self::Coordinator => "isola-coordinator",
            Self::Operator => "isola-operator",
            Self::Worker => "isola-worker",
            Self::Viewer => "isola-viewer",
        }
    }

    /// Whether it may do what that role may.
    pub fn includes(self, other: Self) -> bool {
        self == other || self == Self::Coordinator || other == Self::Viewer
    }

    /// The role of a common name.
    pub fn of_common_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.common_name() == name)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a partner may send about some keys.
struct Rule {
    name: &'static str,
    role: Role,
    messages: &'static [&'static str],
    /// Below `NAMESPACE/VERSION/RUN/`.
    keys: &'static [&'static str],
}

/// What partners may send, besides that everybody hears what they may ask for. Whatever is not here is dropped.
const RULES: &[Rule] = &[
    Rule {
        name: "read",
        role: Role::Viewer,
        messages: &["query"],
        keys: &["run", "model", "backbone", "backbone/*", "windows", "status", "seed/*", "done/*", "result/*"],
    },
    Rule {
        name: "follow",
        role: Role::Viewer,
        messages: &["declare_subscriber"],
        keys: &["run", "status", "seed/*", "done/*", "progress/*"],
    },
    Rule {
        name: "see who is there",
        role: Role::Viewer,
        messages: &["declare_liveliness_subscriber", "liveliness_query"],
        keys: &["alive/coordinator", "alive/worker/*"],
    },
    Rule {
        name: "work",
        role: Role::Worker,
        messages: &["query"],
        keys: &[
            "rpc/lease",
            "rpc/renew",
            "rpc/submit/*",
            "rpc/checkpoint/*",
            "rpc/fail",
            "rpc/release",
            "checkpoint/*",
        ],
    },
    Rule { name: "give orders", role: Role::Operator, messages: &["query"], keys: &["rpc/control"] },
    Rule { name: "be woken", role: Role::Worker, messages: &["declare_subscriber"], keys: &["ctl/hint", "ctl/wake/*"] },
    Rule { name: "tell where a branch is", role: Role::Worker, messages: &["put"], keys: &["progress/*"] },
    Rule { name: "be there", role: Role::Worker, messages: &["liveliness_token"], keys: &["alive/worker/*"] },
];

/// All kinds of messages that access control knows.
const MESSAGES: &str = r#"["put", "delete", "declare_subscriber", "query", "declare_queryable", "reply", "liveliness_token",
        "declare_liveliness_subscriber", "liveliness_query"]"#;

/// Configuration of Zenoh's access control by role for a namespace: of a coordinator that listens, and of a router between.
pub fn access_control(namespace: &str) -> String {
    let listed = |keys: &[&str], before: &str| {
        keys.iter().map(|key| format!("\"{before}{key}\"")).collect::<Vec<_>>().join(", ")
    };
    let rule = |name: &str, flows: &str, messages: &str, keys: &str| {
        format!(
            "    {{ id: \"{name}\", permission: \"allow\", flows: [{flows}],\n      messages: {messages},\n      \
             key_exprs: [{keys}] }},\n"
        )
    };
    let base = format!("{namespace}/*/*/");
    let mut rules = rule("everything", "\"ingress\", \"egress\"", MESSAGES, "\"**\"");
    rules += &rule("hear", "\"egress\"", MESSAGES, "\"**\"");
    for Rule { name, messages, keys, .. } in RULES {
        rules += &rule(name, "\"ingress\"", &format!("[{}]", listed(messages, "")), &listed(keys, &base));
    }
    let subjects: String = Role::ALL
        .map(|role| format!("    {{ id: \"{role}\", cert_common_names: [\"{}\"] }},\n", role.common_name()))
        .concat();
    let policies: String = Role::ALL
        .map(|role| {
            let own = RULES.iter().filter(|rule| role.includes(rule.role)).map(|rule| rule.name);
            let rules: Vec<&str> = if role == Role::Coordinator {
                vec!["everything"]
            } else {
                std::iter::once("hear").chain(own).collect()
            };
            format!("    {{ subjects: [\"{role}\"], rules: [{}] }},\n", listed(&rules, ""))
        })
        .concat();
    format!(
        "{{\n  enabled: true,\n  default_permission: \"deny\",\n  rules: [\n{rules}  ],\n  subjects: [\n{subjects}  ],\n  \
         policies: [\n{policies}  ],\n}}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everybody_may_read_and_a_coordinator_everything() {
        assert!(!Role::Worker.includes(Role::Operator) && !Role::Operator.includes(Role::Worker));
        assert!(!Role::Operator.includes(Role::Coordinator) && !Role::Viewer.includes(Role::Operator));
        for role in Role::ALL {
            assert_eq!(Role::of_common_name(role.common_name()), Some(role));
            assert!(role.includes(role) && role.includes(Role::Viewer) && Role::Coordinator.includes(role));
        }
        assert_eq!(Role::of_common_name("somebody"), None);
    }

    /// `UPDATE_DOCUMENTS=always` writes it.
    #[test]
    fn the_router_that_is_shipped_knows_them() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../deploy/router.json5");
        let text = std::fs::read_to_string(file).unwrap();
        let (head, _) = text.split_once("  access_control: ").unwrap();
        let own = access_control(crate::keys::NAMESPACE).replace('\n', "\n  ");
        let expected = format!("{head}  access_control: {own},\n}}\n");
        if std::env::var_os("UPDATE_DOCUMENTS").is_some() {
            std::fs::write(file, &expected).unwrap();
        }
        assert_eq!(std::fs::read_to_string(file).unwrap(), expected);
        let config = zenoh::Config::from_file(file).unwrap();
        assert!(config.get_json("access_control/enabled").is_ok_and(|enabled| enabled == "true"));
    }
}
