//! Slow connections: every result crosses them once, and signs of life are not kept waiting by them.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tests::System;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpSocket, TcpStream};
use tokio::time::{Instant, sleep_until};

/// Speed of the connection each way, bytes/s.
const SPEED: u64 = 100_000;
/// Time that every byte takes each way.
const DELAY: Duration = Duration::from_millis(100);
/// What the network holds by itself.
const BUFFER: u32 = 1 << 14;

/// A connection of this speed and delay between a worker and a coordinator.
struct Throttle {
    address: String,
    upwards: Arc<AtomicU64>,
    _runtime: tokio::runtime::Runtime,
}

impl Throttle {
    fn to(address: &str) -> Self {
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build().unwrap();
        let target: SocketAddr = address.trim_start_matches("tcp/").parse().unwrap();
        let upwards = Arc::new(AtomicU64::new(0));
        let counted = upwards.clone();
        let address = runtime.block_on(async {
            let socket = TcpSocket::new_v4().unwrap();
            // Those that it accepts have it as well.
            socket.set_recv_buffer_size(BUFFER).unwrap();
            socket.bind("127.0.0.1:0".parse().unwrap()).unwrap();
            let listener = socket.listen(16).unwrap();
            let address = format!("tcp/{}", listener.local_addr().unwrap());
            tokio::spawn(async move {
                while let Ok((client, _)) = listener.accept().await {
                    let socket = TcpSocket::new_v4().unwrap();
                    socket.set_recv_buffer_size(BUFFER).unwrap();
                    let Ok(server) = socket.connect(target).await else { continue };
                    relay(client, server, counted.clone());
                }
            });
            address
        });
        Self { address, upwards, _runtime: runtime }
    }
}

fn relay(client: TcpStream, server: TcpStream, upwards: Arc<AtomicU64>) {
    let (from_client, to_client) = client.into_split();
    let (from_server, to_server) = server.into_split();
    tokio::spawn(slowly(from_client, to_server, Some(upwards)));
    tokio::spawn(slowly(from_server, to_client, None));
}

/// Passes bytes on, as many a second as the connection takes, each after its delay.
async fn slowly(
    mut from: tokio::net::tcp::OwnedReadHalf,
    mut to: tokio::net::tcp::OwnedWriteHalf,
    count: Option<Arc<AtomicU64>>,
) {
    let (arrived, mut arrivals) = tokio::sync::mpsc::unbounded_channel::<(Instant, Vec<u8>)>();
    tokio::spawn(async move {
        while let Some((due, bytes)) = arrivals.recv().await {
            sleep_until(due).await;
            if to.write_all(&bytes).await.is_err() {
                return;
            }
        }
    });
    let mut free = Instant::now();
    let mut buffer = [0; 4096];
    while let Ok(size @ 1..) = from.read(&mut buffer).await {
        if let Some(count) = &count {
            count.fetch_add(size as u64, Ordering::Relaxed);
        }
        free = free.max(Instant::now()) + Duration::from_secs_f64(size as f64 / SPEED as f64);
        if arrived.send((free + DELAY, buffer[..size].to_vec())).is_err() {
            return;
        }
        sleep_until(free).await;
    }
}

/// Results of more than a megabyte take a quarter of a minute each: longer than any lease would last without signs of life.
#[test]
fn a_sweep_over_a_slow_connection() {
    let light = ["--amplitudes", "60", "--search", "none", "--verify", "none", "--set", "harmonics.count=5"];
    let mut system = System::sweep("models/rotor67/study.toml", &[&light[..], &["--lease", "8"]].concat());
    let link = Throttle::to(&system.address());
    let worker = system.worker_at(&link.address);
    system.expect_complete();
    let said = worker.output();
    let largest = system.number("SELECT max(size) FROM results");
    assert!(largest > 10 * SPEED as i64, "results of {largest} bytes are no test");
    let (all, sent) = (system.number("SELECT sum(size) FROM results"), link.upwards.load(Ordering::Relaxed));
    assert!((sent as i64) < all + all / 5 + 100_000, "{sent} bytes for results of {all}\n{said}");
    assert_eq!(system.attempts("coalesce(ending, '') NOT IN ('done', 'confirmed')"), 0, "{said}");
    assert_eq!(system.number("SELECT coalesce(sum(lapses), 0) FROM attempts"), 0, "{said}");
}
