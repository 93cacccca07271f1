//! A viewer that asks for everything again and again: to be frozen by tests.

use protocol::secret::Secret;
use protocol::session::{connect, fetch_all};
use protocol::to_everyone::StoredResult;
use std::time::Duration;

fn main() {
    let usage = "usage: isola-test-viewer ENDPOINT SECRET_FILE";
    let [address, secret] = [1, 2].map(|i| std::env::args().nth(i).expect(usage));
    let secret = Secret::read(secret.as_ref()).expect("the coordinator wrote it");
    tests::block_on(async {
        let session = connect(&address, &Some(secret).into()).await.expect("the coordinator is there");
        let key = format!("isola/v{}/*/result/*", protocol::VERSION);
        let everything = session.declare_subscriber("**").await.expect("anyone may listen");
        loop {
            let found: Vec<StoredResult> = fetch_all(&session, &key, Duration::from_secs(10)).await.unwrap_or_default();
            println!("{} result messages, {} puts", found.len(), everything.drain().count());
        }
    });
}
