//! A viewer that asks for everything again and again: to be frozen by tests.

use protocol::session::{connect, fetch_all};
use protocol::to_everyone::StoredResult;
use std::time::Duration;

fn main() {
    let address = std::env::args().nth(1).expect("usage: isola-test-viewer ENDPOINT");
    tests::block_on(async {
        let session = connect(&address).await.expect("the coordinator is there");
        let everything = session.declare_subscriber("**").await.expect("anyone may listen");
        loop {
            let results: Vec<StoredResult> =
                fetch_all(&session, "isola/v4/*/result/*", Duration::from_secs(10)).await.unwrap_or_default();
            println!("{} result messages, {} puts", results.len(), everything.drain().count());
        }
    });
}
