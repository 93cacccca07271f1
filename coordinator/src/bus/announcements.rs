//! What everybody is told.

use crate::engine::News;
use protocol::codec::{Message, encode, encoding};
use protocol::keys::Keys;
use tokio::sync::mpsc::UnboundedReceiver;
use zenoh::bytes::Encoding;
use zenoh::qos::CongestionControl;
use zenoh::{Session, Wait};

/// Puts news on the bus until there are none any more. Whatever a slow reader misses it can ask for.
pub async fn announce(session: Session, keys: Keys, mut news: UnboundedReceiver<News>) {
    while let Some(news) = news.recv().await {
        match news {
            News::Manifest(manifest) => put(&session, &keys.run(), &*manifest),
            News::Done(done) => put(&session, &keys.done(&done.task), &done),
            News::Status(status) => put(&session, &keys.status(), &status),
            News::Result(..) | News::Withdrawn(_) | News::Load(_) => {}
            News::Hint => nudge(&session, &keys.hint()),
            News::Wake(worker) => nudge(&session, &keys.wake(&worker)),
        }
    }
}

/// Tells that there is something to ask; dropped where there is no room on the way.
fn nudge(session: &Session, key: &str) {
    let put = session.put(key, "").congestion_control(CongestionControl::Drop).wait();
    let _ = put.inspect_err(|error| tracing::debug!(key, %error, "no hint"));
}

/// Puts a message on the bus; dropped where there is no room on the way.
pub(super) fn put<M: Message>(session: &Session, key: &str, message: &M) {
    let put = session
        .put(key, encode(message))
        .encoding(Encoding::from(encoding::<M>()))
        .congestion_control(CongestionControl::Drop);
    if let Err(error) = put.wait() {
        tracing::debug!(key, %error, "not announced");
    }
}
