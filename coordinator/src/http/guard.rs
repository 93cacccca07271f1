//! Who may read.
//!
//! HTTP is not always encrypted, so the secret of a run, with which one may do everything, does not go over it: what does is a token that
//! follows from the secret, and with which one may read. It is shown in a header, or by a browser in a cookie that it is given for
//! the address that the terminal says. Where a run has no secret everybody may read, but no page of somebody else's in a browser:
//! see [`own_names_only`].

use super::host::own_names_only;
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, COOKIE, LOCATION, SET_COOKIE, WWW_AUTHENTICATE};
use axum::http::{HeaderMap, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use protocol::codec::sha256;
use protocol::ids::RunId;
use protocol::secret::Secret;
use std::sync::Arc;

/// What is told to whoever has no token.
const REFUSED: &str = "this run has a secret: open the address that its coordinator printed, or send the header \
                       `Authorization: Bearer TOKEN`, with TOKEN as in the file `http-token` in the folder of the run\n";

/// With what the page and the figures of a run may be read: SHA-256 of `isola http ` and its secret.
pub fn token(secret: &Secret) -> String {
    sha256(format!("isola http {}", secret.reveal()).as_bytes())
}

/// Lets in who may read.
pub struct Guard {
    /// What has to be shown, if anything.
    token: Option<String>,
    /// Other runs on this machine have other cookies, which are the same for all ports.
    cookie: String,
    /// A browser shows it over encrypted connections alone.
    is_encrypted: bool,
}

impl Guard {
    /// Of a run, with a secret if it has one.
    pub fn new(secret: Option<&Secret>, run: &RunId, is_encrypted: bool) -> Self {
        Self { token: secret.map(token), cookie: format!("isola-{run}"), is_encrypted }
    }

    fn is_shown(&self, headers: &HeaderMap, token: &str) -> bool {
        let texts = |name| headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
        let mut bearers = texts(AUTHORIZATION).filter_map(|value| value.split_once(' '));
        let mut cookies =
            texts(COOKIE).flat_map(|value| value.split(';')).filter_map(|pair| pair.trim().split_once('='));
        bearers.any(|(scheme, shown)| scheme.eq_ignore_ascii_case("bearer") && is_same(shown.trim(), token))
            || cookies.any(|(name, shown)| name == self.cookie && is_same(shown, token))
    }
}

/// Compares hashes: how long that takes tells nothing of the token.
fn is_same(shown: &str, token: &str) -> bool {
    sha256(shown.as_bytes()) == sha256(token.as_bytes())
}

/// The token in an address.
fn typed(uri: &Uri) -> Option<&str> {
    uri.query()?.split('&').find_map(|pair| pair.strip_prefix("token="))
}

/// Lets requests through that may read; a browser that shows the token in the address keeps it, and the address does not.
pub async fn let_in(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let Some(token) = &guard.token else { return own_names_only(request, next).await };
    if typed(request.uri()).is_some_and(|shown| is_same(shown, token)) {
        let secure = if guard.is_encrypted { "; Secure" } else { "" };
        let cookie = format!("{}={token}; Path=/; HttpOnly; SameSite=Strict{secure}", guard.cookie);
        let path = request.uri().path().to_string();
        return (StatusCode::SEE_OTHER, [(SET_COOKIE, cookie), (LOCATION, path)]).into_response();
    }
    if guard.is_shown(request.headers(), token) {
        return next.run(request).await;
    }
    (StatusCode::UNAUTHORIZED, [(WWW_AUTHENTICATE, "Bearer")], REFUSED).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_token_is_what_the_manual_says() {
        let secret: Secret = "0123456789abcdef".parse().unwrap();
        // printf 'isola http %s' 0123456789abcdef | sha256sum
        assert_eq!(token(&secret), "75a52b8f56e52be45bf5ad0f76b847664071613f0a2c187c1ebe02bb65322229");
    }

    #[test]
    fn where_a_token_is_looked_for() {
        let secret: Secret = "0123456789abcdef".parse().unwrap();
        let (guard, token) = (Guard::new(Some(&secret), &RunId::new("r1").unwrap(), false), token(&secret));
        let shown = |name, value: String| {
            let headers = [(name, value.parse().unwrap())].into_iter().collect();
            guard.is_shown(&headers, &token)
        };
        assert!(shown(AUTHORIZATION, format!("Bearer {token}")) && shown(AUTHORIZATION, format!("bearer {token}")));
        assert!(shown(COOKIE, format!("a=b; isola-r1={token}")));
        for other in [format!("Basic {token}"), token.clone(), "Bearer".into(), format!("Bearer {}", secret.reveal())] {
            assert!(!shown(AUTHORIZATION, other.clone()), "{other}");
        }
        for other in [format!("isola-r2={token}"), "isola-r1=".into(), token.clone()] {
            assert!(!shown(COOKIE, other.clone()), "{other}");
        }
        assert_eq!(typed(&"/?a=b&token=x".parse().unwrap()), Some("x"));
        assert_eq!(typed(&"/?atoken=x".parse().unwrap()), None);
    }
}
