//! HTTPS with the certificate by which a coordinator is known on the bus as well. Who asks need show none: the token says who may read.

use crate::error::Error;
use axum::Router;
use axum::http::StatusCode;
use protocol::certificate::{CERTIFICATE, Certificate, KEY};
use std::fmt;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{self, ServerConfig, version};
use tokio_rustls::server::TlsStream;

/// What an encrypted connection begins with: a record of a handshake.
const HANDSHAKE: u8 = 22;

/// What encrypts the connections of a server.
#[derive(Clone)]
pub struct Encryption(TlsAcceptor);

/// How somebody speaks who has connected.
pub enum Spoken {
    /// As it should be.
    Encrypted(Box<TlsStream<TcpStream>>),
    /// In clear text.
    Clear(TcpStream),
}

impl Encryption {
    /// By the certificates of a coordinator, with the algorithms that Zenoh has for its own connections.
    ///
    /// # Errors
    /// If a file cannot be read, or the key is not that of the certificate.
    pub fn of(certificate: &Certificate) -> Result<Self, Error> {
        let (chain, key) = (certificate.file(CERTIFICATE), certificate.file(KEY));
        let refused = |file: &std::path::Path, why: &dyn fmt::Display| {
            Error::Other(format!("{}: {why}: nothing can be served over HTTPS with that", file.display()))
        };
        let chained = CertificateDer::pem_file_iter(&chain).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let chained = chained.map_err(|error| refused(&chain, &error))?;
        let private = PrivateKeyDer::from_pem_file(&key).map_err(|error| refused(&key, &error))?;
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_protocol_versions(&[&version::TLS13])
            .and_then(|builder| builder.with_no_client_auth().with_single_cert(chained, private));
        let mut config = config.map_err(|error: rustls::Error| refused(&key, &error))?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(Self(TlsAcceptor::from(Arc::new(config))))
    }

    /// Begins a connection; who says nothing for so long is not waited for.
    ///
    /// # Errors
    /// If it ends before it has begun.
    pub async fn begin(&self, stream: TcpStream, patience: Duration) -> io::Result<Spoken> {
        let begun = timeout(patience, async {
            let mut first = [0];
            if stream.peek(&mut first).await? == 1 && first[0] != HANDSHAKE {
                return Ok(Spoken::Clear(stream));
            }
            self.0.accept(stream).await.map(|stream| Spoken::Encrypted(Box::new(stream)))
        });
        begun.await.unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into()))
    }
}

/// What is told to whoever asks in clear text, whatever it is.
pub fn refusal() -> Router {
    let why = "this run is served over HTTPS alone: ask for https://, and trust the ca.crt of its certificates\n";
    Router::new().fallback(move || async move { (StatusCode::BAD_REQUEST, why) })
}
