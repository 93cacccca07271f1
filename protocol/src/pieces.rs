//! Large messages in pieces, each answered before others follow.
//!
//! Zenoh takes a message of any size, cuts it up itself, and holds the lock of its queue until the last of it has found room. When
//! the partner falls silent meanwhile, whoever gives the connection up waits for that lock, and nothing is connected again. Pieces
//! that find room at once cannot bring that about; they keep small messages from waiting for megabytes; and a connection that
//! breaks costs a piece, not the message.

use crate::codec::{CodecError, Message, decode_stored, encode, encoding, messages};
use crate::session::{Answer, RequestError, ask_in_background};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use zenoh::Session;
use zenoh::bytes::ZBytes;

/// Largest piece, bytes: with all that goes with it, it fits into one of the batches, of 64 KiB, that Zenoh sends.
pub const PIECE: usize = 60 << 10;

/// How long a piece may take; it is sent again afterwards. A partner that is silent is given up before that.
const ANSWER: Duration = Duration::from_secs(15);
/// A piece that is answered sooner is followed by two at a time.
const QUICK: Duration = Duration::from_millis(500);
/// Time until a piece is sent again.
const PAUSE: Duration = Duration::from_millis(300);

/// Which piece of which message this is: attached to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Piece {
    /// Name of the message, no other's.
    pub message: String,
    /// Number of the piece, from 0.
    pub number: usize,
    /// Size of the whole message, bytes.
    pub size: usize,
}

/// Answer to a piece after which others are to come. The one that completes the message is answered as the message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PieceReply {
    /// It is kept.
    Taken,
    /// No room for the message now: to be sent again later.
    Busy,
    /// Others are not there, or not any more: to be sent from the beginning.
    Missing,
}

impl Piece {
    /// What is attached to a piece.
    ///
    /// # Errors
    /// If it is something else.
    pub fn read(attached: &ZBytes) -> Result<Self, CodecError> {
        decode_stored(&attached.to_bytes())
    }

    /// Number of pieces of the message.
    pub fn count(&self) -> usize {
        self.size.div_ceil(PIECE)
    }

    /// Which bytes of the message it is; nothing of a number that does not exist.
    pub fn bytes(&self) -> Range<usize> {
        let at = |number: usize| number.saturating_mul(PIECE).min(self.size);
        at(self.number)..at(self.number.saturating_add(1))
    }
}

/// [`request`](crate::session::request) behind everything else that is to be sent, with the payload at hand, in pieces: for results,
/// which may take long.
///
/// # Errors
/// Those of [`request`](crate::session::request).
pub async fn request_in_pieces<R: Message>(
    session: &Session,
    key: &str,
    payload: &ZBytes,
    encoding: &str,
    timeout: Duration,
) -> Result<R, RequestError> {
    if payload.len() <= PIECE {
        return ask_in_background(session, key, payload.clone(), encoding, None, timeout).await?.read();
    }
    let message = Outgoing {
        session,
        key,
        encoding,
        name: format!("{}-{}", session.zid(), SENT.fetch_add(1, Ordering::Relaxed)),
        bytes: payload.to_bytes(),
        deadline: Instant::now() + timeout,
    };
    if let Some(early) = message.send_all_but_the_last().await? {
        return early.read();
    }
    let answer = message.send(message.piece(message.last()), message.left()).await?;
    // Nothing comes after the last one: the others are not there any more.
    if answer.encoding == self::encoding::<PieceReply>() { Err(RequestError::NoReply) } else { answer.read() }
}

/// How many messages were sent in pieces.
static SENT: AtomicU64 = AtomicU64::new(0);

/// A message on its way.
struct Outgoing<'a> {
    session: &'a Session,
    key: &'a str,
    encoding: &'a str,
    name: String,
    bytes: Cow<'a, [u8]>,
    deadline: Instant,
}

impl Outgoing<'_> {
    fn piece(&self, number: usize) -> Piece {
        Piece { message: self.name.clone(), number, size: self.bytes.len() }
    }

    fn last(&self) -> usize {
        self.piece(0).count() - 1
    }

    fn left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }

    /// Sends the pieces, two at a time where that is quick; ends early if the message is answered.
    async fn send_all_but_the_last(&self) -> Result<Option<Answer>, RequestError> {
        let (mut numbers, mut is_quick) = (0..self.last(), false);
        while let Some(first) = numbers.next() {
            let second = if is_quick { numbers.next() } else { None };
            let began = Instant::now();
            let second = async {
                match second {
                    Some(number) => self.insist(number).await,
                    None => Ok(None),
                }
            };
            let (first, second) = tokio::try_join!(self.insist(first), second)?;
            if let Some(answer) = first.or(second) {
                return Ok(Some(answer));
            }
            is_quick = began.elapsed() < QUICK;
        }
        Ok(None)
    }

    /// Sends a piece until it is taken, or the message is answered.
    async fn insist(&self, number: usize) -> Result<Option<Answer>, RequestError> {
        loop {
            match self.send(self.piece(number), ANSWER.min(self.left())).await {
                Ok(answer) if answer.encoding != encoding::<PieceReply>() => return Ok(Some(answer)),
                Ok(answer) => match answer.read()? {
                    PieceReply::Taken => return Ok(None),
                    PieceReply::Busy => {}
                    PieceReply::Missing => return Err(RequestError::NoReply),
                },
                Err(RequestError::NoReply) if !self.left().is_zero() => {}
                Err(error) => return Err(error),
            }
            tokio::time::sleep(PAUSE).await;
        }
    }

    async fn send(&self, piece: Piece, timeout: Duration) -> Result<Answer, RequestError> {
        let payload = ZBytes::from(self.bytes[piece.bytes()].to_vec());
        let attached = Some(ZBytes::from(encode(&piece)));
        ask_in_background(self.session, self.key, payload, self.encoding, attached, timeout).await
    }
}

messages! {
    Piece => "piece",
    PieceReply => "piece_reply",
}
