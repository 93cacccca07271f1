//! Zenoh sessions that open nothing but what they are told to, and requests that end.

use crate::codec::{CodecError, Message, decode, encode, encoding};
use crate::credentials::{Credentials, ENCRYPTED};
use crate::handshake;
use crate::role::access_control;
use crate::secret::{Dictionary, USER};
use std::time::Duration;
use thiserror::Error;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::handlers::FifoChannelHandler;
use zenoh::qos::Priority;
use zenoh::query::{ConsolidationMode, Query, Reply};
use zenoh::sample::Sample;
use zenoh::{Config, Session};

/// Why there is no session.
#[derive(Debug, Error)]
pub enum SessionError {
    /// An endpoint that is none.
    #[error("`{endpoint}` is not an endpoint; write it like tcp/HOST:7447 ({reason})")]
    Endpoint {
        /// As given.
        endpoint: String,
        /// What Zenoh says.
        reason: String,
    },
    /// Nobody listens there.
    #[error(
        "no coordinator or router can be reached at {endpoint}; start one there with `isola sweep STUDY --listen \
         tcp/0.0.0.0:PORT`, or check host, port and firewall; {}", if *is_secret { "another secret than the run's looks the \
         same" } else { "not to have its secret looks the same: it is in the file `secret` in the folder of the run, name a copy \
         of it with --secret-file" }
    )]
    Unreachable {
        /// Where.
        endpoint: String,
        /// Whether a secret was given.
        is_secret: bool,
    },
    /// The endpoint and what is shown there do not go together.
    #[error("{endpoint}: {problem}")]
    Encryption {
        /// As given.
        endpoint: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// Somebody listens there, who and whose certificate are not accepted here, or does not accept the one of this side.
    #[error("no encrypted connection to {endpoint}: {reason}")]
    Refused {
        /// Where.
        endpoint: String,
        /// Why.
        reason: String,
    },
    /// The address cannot be listened on.
    #[error("cannot listen on {endpoint}: {reason}; choose another port, or leave --listen out for a free one")]
    Listen {
        /// Where.
        endpoint: String,
        /// What Zenoh says.
        reason: String,
    },
}

/// Largest result, bytes.
pub const MAX_RESULT_BYTES: usize = 256 << 20;
/// What a coordinator takes at most in one piece: a result, and what is said of it.
const MAX_MESSAGE_BYTES: usize = MAX_RESULT_BYTES + (1 << 20);
/// Most partners of a coordinator at a time.
const MAX_SESSIONS: usize = 1000;

/// How long a client tries to connect.
const CONNECT_MS: u64 = 3000;
/// A partner that has been silent for so long is gone.
const TRANSPORT_LEASE_MS: u64 = 5000;

/// What the system holds of a connection that is slower than this side, bytes: a small message of a client waits for as much,
/// whatever its priority. At 100 kB/s that is a second or two. A coordinator keeps what the system gives: a viewer that is frozen
/// must not hold up others.
const SEND_BUFFER: usize = 1 << 16;

fn config(settings: &[(&str, String)]) -> Config {
    let mut config = Config::default();
    let common = [
        ("scouting/multicast/enabled", "false".to_string()),
        ("scouting/gossip/enabled", "false".to_string()),
        // A router waits for so long at its start even if it looks for nobody; the default is 500 ms.
        ("scouting/delay", "0".to_string()),
        ("adminspace/enabled", "false".to_string()),
        ("transport/link/tx/lease", TRANSPORT_LEASE_MS.to_string()),
    ];
    for (key, value) in common.iter().map(|(k, v)| (*k, v)).chain(settings.iter().map(|(k, v)| (*k, v))) {
        config.insert_json5(key, value).expect("keys and values of Zenoh's configuration are known");
    }
    config
}

fn endpoints(endpoint: &str) -> Result<String, SessionError> {
    endpoint
        .parse::<zenoh::config::EndPoint>()
        .map_err(|error| SessionError::Endpoint { endpoint: endpoint.to_string(), reason: error.to_string() })?;
    Ok(format!("[{endpoint:?}]"))
}

fn encryption(endpoint: &str, credentials: &Credentials) -> Result<Vec<(&'static str, String)>, SessionError> {
    let of_problem = |problem| SessionError::Encryption { endpoint: endpoint.to_string(), problem };
    credentials.encryption(endpoint).map_err(of_problem)
}

/// Session of a coordinator: a router that listens on `endpoint` and nowhere else, and lets those in that have the secret if there
/// is one. On an encrypted endpoint it lets those in that have a certificate of the same authority, to do in this namespace what
/// their [role](crate::role) may.
///
/// # Errors
/// If the endpoint is none, its port is in use, there is no certificate for it, or the secret cannot be handed on.
pub async fn listen(endpoint: &str, credentials: &Credentials, namespace: &str) -> Result<Session, SessionError> {
    let dictionary =
        credentials.secret.as_ref().map(Dictionary::of).transpose().map_err(|error| SessionError::Listen {
            endpoint: endpoint.to_string(),
            reason: format!("the secret cannot be handed on: {error}"),
        })?;
    let mut settings = vec![
        ("mode", "\"router\"".to_string()),
        ("listen/endpoints", endpoints(endpoint)?),
        ("listen/exit_on_failure", "true".to_string()),
        ("listen/timeout_ms", "0".to_string()),
        ("transport/link/rx/max_message_size", MAX_MESSAGE_BYTES.to_string()),
        ("transport/unicast/max_sessions", MAX_SESSIONS.to_string()),
    ];
    settings.extend(encryption(endpoint, credentials)?);
    if endpoint.starts_with(ENCRYPTED) {
        settings.push(("access_control", access_control(namespace)));
    }
    if let Some(dictionary) = &dictionary {
        let file = dictionary.file().display().to_string();
        settings.push(("transport/auth/usrpwd/dictionary_file", format!("{file:?}")));
    }
    zenoh::open(config(&settings)).await.map_err(|error| SessionError::Listen {
        endpoint: endpoint.to_string(),
        reason: root_cause(&error.to_string()),
    })
}

/// Session of a client of the router at `endpoint`, which asks for this secret if there is one, and for a certificate if it is an
/// encrypted one; listens nowhere.
///
/// # Errors
/// If the endpoint is none, there is no certificate for it, or nobody is there who lets these credentials in.
pub async fn connect(endpoint: &str, credentials: &Credentials) -> Result<Session, SessionError> {
    let link =
        if endpoint.starts_with(ENCRYPTED) { "transport/link/tls/so_sndbuf" } else { "transport/link/tcp/so_sndbuf" };
    let mut settings = vec![
        ("mode", "\"client\"".to_string()),
        ("connect/endpoints", endpoints(endpoint)?),
        ("connect/timeout_ms", CONNECT_MS.to_string()),
        ("connect/exit_on_failure", "true".to_string()),
        ("connect/retry", "{ period_init_ms: 200, period_max_ms: 1000 }".to_string()),
        (link, SEND_BUFFER.to_string()),
    ];
    settings.extend(encryption(endpoint, credentials)?);
    if let Some(secret) = &credentials.secret {
        settings.push(("transport/auth/usrpwd/user", format!("{USER:?}")));
        settings.push(("transport/auth/usrpwd/password", format!("{:?}", secret.reveal())));
    }
    match zenoh::open(config(&settings)).await {
        Ok(session) => Ok(session),
        Err(_) => Err(unreachable(endpoint, credentials).await),
    }
}

/// Why there is no session, as far as this side can know: certificates that do not go together are told from everything else.
pub async fn unreachable(endpoint: &str, credentials: &Credentials) -> SessionError {
    let endpoint = endpoint.to_string();
    let reason = match &credentials.certificate {
        Some(certificate) => handshake::refusal(&endpoint, certificate).await,
        None => None,
    };
    match reason {
        Some(reason) => SessionError::Refused { endpoint, reason },
        None => SessionError::Unreachable { endpoint, is_secret: credentials.secret.is_some() },
    }
}

/// The last and most precise part of a chain of messages.
fn root_cause(message: &str) -> String {
    if message.contains("Address already in use") || message.contains("in use") {
        return "the port is in use".to_string();
    }
    message.split(" at /").next().unwrap_or(message).trim().to_string()
}

/// Why a request has no answer.
#[derive(Debug, Error)]
pub enum RequestError {
    /// Nobody is there, or the answer did not come in time: try again.
    #[error("no answer from the coordinator")]
    NoReply,
    /// The request was refused as it is.
    #[error("refused: {0}")]
    Refused(String),
    /// The answer is not what it should be.
    #[error(transparent)]
    Codec(#[from] CodecError),
    /// The session is closed.
    #[error("the session is closed: {0}")]
    Closed(String),
}

/// Asks whoever answers `key`, with a message as payload.
///
/// # Errors
/// If nobody answers within `timeout`, refuses, or answers something else, and if the session is closed.
pub async fn request<Q: Message, R: Message>(
    session: &Session,
    key: &str,
    question: &Q,
    timeout: Duration,
) -> Result<R, RequestError> {
    request_encoded(session, key, encode(question), &encoding::<Q>(), timeout).await
}

/// [`request`] with the payload at hand, for results that are sent again.
///
/// # Errors
/// Those of [`request`].
pub async fn request_encoded<R: Message>(
    session: &Session,
    key: &str,
    payload: impl Into<ZBytes>,
    encoding: &str,
    timeout: Duration,
) -> Result<R, RequestError> {
    let question = Question { payload: payload.into(), encoding, attached: None };
    let replies = ask(session, key, Some(question), Priority::DEFAULT, timeout).await?;
    first(&replies).await?.read()
}

/// [`request_encoded`] behind everything else that is to be sent, with something attached if need be: the answer as it comes.
pub(crate) async fn ask_in_background(
    session: &Session,
    key: &str,
    payload: ZBytes,
    encoding: &str,
    attached: Option<ZBytes>,
    timeout: Duration,
) -> Result<Answer, RequestError> {
    let question = Question { payload, encoding, attached };
    first(&ask(session, key, Some(question), Priority::Background, timeout).await?).await
}

/// [`fetch`] behind everything else that is to be answered: for results, which may take long.
///
/// # Errors
/// Those of [`fetch`].
pub async fn fetch_bulk<R: Message>(session: &Session, key: &str, timeout: Duration) -> Result<R, RequestError> {
    let replies = ask(session, key, None, Priority::Background, timeout).await?;
    first(&replies).await?.read()
}

/// Fetches a message that needs no question.
///
/// # Errors
/// If nobody answers within `timeout`, refuses, or answers something else, and if the session is closed.
pub async fn fetch<R: Message>(session: &Session, key: &str, timeout: Duration) -> Result<R, RequestError> {
    let replies = ask(session, key, None, Priority::DEFAULT, timeout).await?;
    first(&replies).await?.read()
}

/// Fetches everything that answers a key with wildcards; what cannot be read is left out.
///
/// # Errors
/// If the session is closed.
pub async fn fetch_all<R: Message>(session: &Session, key: &str, timeout: Duration) -> Result<Vec<R>, RequestError> {
    let replies = ask(session, key, None, Priority::DEFAULT, timeout).await?;
    Ok(all(&replies).await.iter().filter_map(|answer| answer.read().ok()).collect())
}

/// Fetches everything that answers a key with wildcards.
///
/// # Errors
/// If the session is closed, and if an answer is something else.
pub async fn fetch_every<R: Message>(session: &Session, key: &str, timeout: Duration) -> Result<Vec<R>, RequestError> {
    let replies = ask(session, key, None, Priority::DEFAULT, timeout).await?;
    all(&replies).await.iter().map(Answer::read).collect()
}

/// Fetches a message as it comes: payload and encoding.
///
/// # Errors
/// If nobody answers within `timeout` or refuses, and if the session is closed.
pub async fn fetch_answer(session: &Session, key: &str, timeout: Duration) -> Result<(Vec<u8>, String), RequestError> {
    let replies = ask(session, key, None, Priority::DEFAULT, timeout).await?;
    let Answer { payload, encoding } = first(&replies).await?;
    Ok((payload.to_bytes().into_owned(), encoding))
}

type Replies = FifoChannelHandler<Reply>;

/// An answer as it came.
pub(crate) struct Answer {
    payload: ZBytes,
    pub(crate) encoding: String,
}

impl Answer {
    fn of(sample: &Sample) -> Self {
        Self { payload: sample.payload().clone(), encoding: sample.encoding().to_string() }
    }

    pub(crate) fn read<R: Message>(&self) -> Result<R, RequestError> {
        Ok(decode(&self.payload.to_bytes(), &self.encoding)?)
    }
}

/// What is asked, if more than a key.
struct Question<'a> {
    payload: ZBytes,
    encoding: &'a str,
    attached: Option<ZBytes>,
}

async fn ask(
    session: &Session,
    key: &str,
    question: Option<Question<'_>>,
    priority: Priority,
    timeout: Duration,
) -> Result<Replies, RequestError> {
    let get = session.get(key).consolidation(ConsolidationMode::None).priority(priority).timeout(timeout);
    let get = match question {
        Some(Question { payload, encoding, attached }) => {
            get.payload(payload).encoding(Encoding::from(encoding)).attachment(attached)
        }
        None => get,
    };
    get.await.map_err(|error| RequestError::Closed(error.to_string()))
}

async fn all(replies: &Replies) -> Vec<Answer> {
    let mut answers = Vec::new();
    while let Ok(reply) = replies.recv_async().await {
        answers.extend(reply.result().ok().map(Answer::of));
    }
    answers
}

async fn first(replies: &Replies) -> Result<Answer, RequestError> {
    while let Ok(reply) = replies.recv_async().await {
        match reply.result() {
            Ok(sample) => return Ok(Answer::of(sample)),
            // Zenoh itself answers with an error when time is up or the partner is gone.
            Err(error) if error.encoding().to_string() == REFUSAL => {
                return Err(RequestError::Refused(String::from_utf8_lossy(&error.payload().to_bytes()).into_owned()));
            }
            Err(_) => {}
        }
    }
    Err(RequestError::NoReply)
}

/// Encoding of a refusal in words.
pub const REFUSAL: &str = "text/plain;isola.refusal";

/// The message that came with a query.
///
/// # Errors
/// If there is none, or something else.
pub fn question<Q: Message>(query: &Query) -> Result<Q, CodecError> {
    let payload = query.payload().map(|payload| payload.to_bytes()).unwrap_or_default();
    decode(&payload, &encoding_of(query))
}

/// Encoding of the message that came with a query.
pub fn encoding_of(query: &Query) -> String {
    query.encoding().map(|encoding| encoding.to_string()).unwrap_or_default()
}

/// Answers a query. Waits for room on the way to whoever asked: not to be called where waiting hurts.
pub fn answer<R: Message>(query: &Query, key: &str, message: &R) {
    answer_encoded(query, key, encode(message), &encoding::<R>());
}

/// [`answer`] with the payload at hand.
pub fn answer_encoded(query: &Query, key: &str, payload: impl Into<ZBytes>, encoding: &str) {
    use zenoh::Wait;
    if let Err(error) = query.reply(key, payload).encoding(Encoding::from(encoding)).wait() {
        tracing::debug!(key, %error, "whoever asked is gone");
    }
}

/// Refuses a query in words.
pub fn refuse(query: &Query, why: &str) {
    use zenoh::Wait;
    if let Err(error) = query.reply_err(why).encoding(Encoding::from(REFUSAL)).wait() {
        tracing::debug!(%error, "whoever asked is gone");
    }
}
