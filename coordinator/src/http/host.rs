//! Whose page it is: a browser that was led here under another name is sent away.
//!
//! Somebody else's page can have a name of its own resolve to this machine (DNS rebinding), and would then be let read by the
//! browser what this one serves. It cannot make the browser ask for an address or for this machine's name.

use axum::extract::Request;
use axum::http::StatusCode;
use axum::http::header::HOST;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::IpAddr;

/// Refuses requests that are not for an address, for `localhost` or for this machine by its name.
pub async fn own_names_only(request: Request, next: Next) -> Response {
    let host = request.headers().get(HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    if is_own(host, &machine()) {
        return next.run(request).await;
    }
    let why = format!("this page is not served as `{host}`: open it by the address that was printed\n");
    (StatusCode::MISDIRECTED_REQUEST, why).into_response()
}

fn is_own(host: &str, machine: &str) -> bool {
    let is_port = |port: &str| port.bytes().all(|digit| digit.is_ascii_digit());
    let name = match host.rsplit_once(':') {
        Some((name, port)) if is_port(port) && !name.ends_with(':') => name,
        _ => host,
    };
    let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    let is_machine = !machine.is_empty() && name.eq_ignore_ascii_case(machine);
    bare.parse::<IpAddr>().is_ok() || name.eq_ignore_ascii_case("localhost") || is_machine
}

/// The name of this machine; nothing if it cannot be told.
fn machine() -> String {
    std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default().trim().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_own_names() {
        for own in ["127.0.0.1:8080", "10.0.0.7", "[::1]:8080", "localhost:1", "LOCALHOST", "blade", "blade:80"] {
            assert!(is_own(own, "blade"), "{own}");
        }
        for other in [
            "",
            "evil.example",
            "evil.example:8080",
            "127.0.0.1.evil.example:80",
            "localhost.evil.example",
            "blade.evil.example",
        ] {
            assert!(!is_own(other, "blade") && !is_own(other, ""), "{other}");
        }
    }
}
