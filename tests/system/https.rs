//! Where a run has certificates what it serves over HTTP is encrypted.

use crate::certificates::{certificates, endpoint, text};
use crate::{BRIEF, DAMPER, LEVELS, LONG};
use protocol::certificate::AUTHORITY;
use std::io;
use std::path::Path;
use std::sync::Arc;
use tests::{System, block_on};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName};
use tokio_rustls::rustls::{ClientConfig, RootCertStore, version};

/// Asks on a connection, and reads until it ends.
async fn ask(mut stream: impl AsyncRead + AsyncWrite + Unpin, path: &str, header: &str) -> io::Result<String> {
    let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n{header}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).await?;
    let mut answer = Vec::new();
    // Not everybody takes leave in order.
    let _ = stream.read_to_end(&mut answer).await;
    Ok(String::from_utf8_lossy(&answer).into_owned())
}

/// The same, encrypted, by somebody who trusts this authority alone.
async fn ask_encrypted(place: &str, authority: &Path, path: &str, header: &str) -> io::Result<String> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(authority.join(AUTHORITY)).unwrap()).unwrap();
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        .with_protocol_versions(&[&version::TLS13])
        .unwrap()
        .with_root_certificates(roots)
        .with_no_client_auth();
    let stream = TcpStream::connect(place).await.unwrap();
    let name = ServerName::try_from("127.0.0.1").unwrap();
    ask(TlsConnector::from(Arc::new(config)).connect(name, stream).await?, path, header).await
}

#[test]
fn who_trusts_the_authority_reads_and_clear_text_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let address = endpoint();
    let made = certificates(folder.path(), &address);
    let other = certificates(&folder.path().join("made-elsewhere"), &address);
    let tls = made.join("coordinator");
    let options = ["--listen", &address, "--tls", text(&tls), "--http", "127.0.0.1:0"];
    let system = System::sweep(DAMPER, &[LEVELS, BRIEF, LONG, &options].concat());
    let file = system.directory().join("http");
    system.eventually("an address", |_| file.exists());
    let url = std::fs::read_to_string(file).unwrap();
    let place = url.trim().strip_prefix("https://").expect("an address that is encrypted");
    let token = std::fs::read_to_string(system.directory().join("http-token")).unwrap();
    let bearer = format!("Authorization: Bearer {}\r\n", token.trim());
    block_on(async {
        let get = async |path: &str, header: &str| ask_encrypted(place, &made, path, header).await.unwrap();
        let health = get("/healthz", "").await;
        assert!(health.starts_with("HTTP/1.1 200 "), "{health}");
        let (refused, told) = (get("/metrics", "").await, get("/metrics", &bearer).await);
        assert!(refused.starts_with("HTTP/1.1 401 "), "{refused}");
        assert!(told.starts_with("HTTP/1.1 200 ") && told.contains("isola_attempts_failed_total"), "{told}");
        let cookie = get(&format!("/?token={}", token.trim()), "").await;
        assert!(cookie.starts_with("HTTP/1.1 303 ") && cookie.contains("; Secure"), "{cookie}");
        let stranger = ask_encrypted(place, &other, "/healthz", "").await;
        assert!(stranger.is_err(), "another authority is trusted: {stranger:?}");
        let clear = ask(TcpStream::connect(place).await.unwrap(), "/healthz", &bearer).await.unwrap();
        assert!(clear.starts_with("HTTP/1.1 400 ") && clear.contains("served over HTTPS alone"), "{clear}");
    });
}
