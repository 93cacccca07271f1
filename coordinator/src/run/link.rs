//! Whether this process is connected, where it reaches its workers over somebody else's router.

use crate::engine::{Decider, Event};
use std::sync::Arc;
use std::time::Duration;
use zenoh::Session;

/// Time between two looks.
const PERIOD: Duration = Duration::from_millis(200);

/// Tells the engine as long as there is no router, and once more when there is one again: nobody can be heard of meanwhile. Ends
/// with the engine.
pub(super) async fn watch(session: Session, engine: Arc<Decider>) {
    let mut was_cut = false;
    loop {
        tokio::time::sleep(PERIOD).await;
        let is_cut = session.info().routers_zid().await.next().is_none();
        if (is_cut || was_cut) && !engine.tell(Event::Stalled) {
            return;
        }
        if is_cut != was_cut {
            tracing::warn!("{}", if is_cut { "the router is gone" } else { "the router is back" });
        }
        was_cut = is_cut;
    }
}
