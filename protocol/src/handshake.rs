//! Why somebody with a certificate is not let in: an encrypted connection begun once more, for what Zenoh does not tell.

use crate::certificate::{AUTHORITY, CERTIFICATE, Certificate, KEY};
use crate::credentials::ENCRYPTED;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::{AlertDescription, CertificateError, ClientConfig, ClientConnection, Error, RootCertStore, Stream};
use std::io::{self, Read};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

/// How long each step may take. Whoever refuses a certificate says so at once.
const STEP: Duration = Duration::from_secs(1);

/// Why the other side and these certificates do not go together, in words; nothing if nobody listens there, or if they do: then
/// it is something else. Takes a few seconds at most.
pub(crate) async fn refusal(endpoint: &str, certificate: &Certificate) -> Option<String> {
    let address = endpoint.strip_prefix(ENCRYPTED)?.split(['?', '#']).next()?.to_string();
    let certificate = certificate.clone();
    tokio::task::spawn_blocking(move || attempt(&address, &certificate)).await.ok()?
}

fn attempt(address: &str, certificate: &Certificate) -> Option<String> {
    let (host, _) = address.rsplit_once(':')?;
    let name = ServerName::try_from(host.trim_matches(['[', ']']).to_string()).ok()?;
    let config = match config(certificate) {
        Ok(config) => config,
        Err(error) => {
            return Some(format!("the certificates in {} cannot be used: {error}", certificate.folder().display()));
        }
    };
    let target = address.to_socket_addrs().ok()?.next()?;
    let mut socket = TcpStream::connect_timeout(&target, STEP).ok()?;
    socket.set_read_timeout(Some(STEP)).ok()?;
    socket.set_write_timeout(Some(STEP)).ok()?;
    let mut connection = ClientConnection::new(Arc::new(config), name).ok()?;
    // A router of Zenoh waits for the first word: what it has to say against the certificate comes before.
    let mut byte = [0];
    let error = match Stream::new(&mut connection, &mut socket).read(&mut byte) {
        Err(error) => error,
        Ok(_) => return None,
    };
    match error.get_ref().and_then(|inner| inner.downcast_ref::<Error>()) {
        Some(error) => Some(words(error)),
        None if error.kind() == io::ErrorKind::UnexpectedEof && connection.is_handshaking() => {
            Some("whoever listens there closes encrypted connections: does it listen on tls/…?".into())
        }
        None => None,
    }
}

fn config(certificate: &Certificate) -> Result<ClientConfig, String> {
    let mut roots = RootCertStore::empty();
    for authority in CertificateDer::pem_file_iter(certificate.file(AUTHORITY)).map_err(|error| error.to_string())? {
        let authority = authority.map_err(|error| format!("{AUTHORITY}: {error}"))?;
        roots.add(authority).map_err(|error| format!("{AUTHORITY}: {error}"))?;
    }
    let own = CertificateDer::pem_file_iter(certificate.file(CERTIFICATE)).and_then(Iterator::collect);
    let key = PrivateKeyDer::from_pem_file(certificate.file(KEY));
    ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_protocol_versions(&[&rustls::version::TLS13])
        .map_err(|error| error.to_string())?
        .with_root_certificates(roots)
        .with_client_auth_cert(
            own.map_err(|error| format!("{CERTIFICATE}: {error}"))?,
            key.map_err(|error| format!("{KEY}: {error}"))?,
        )
        .map_err(|error| format!("{CERTIFICATE} and {KEY}: {error}"))
}

/// What an error means for whoever has to do something about it.
fn words(error: &Error) -> String {
    let theirs = "the certificate that is shown there";
    match error {
        Error::InvalidCertificate(CertificateError::NotValidForNameContext { presented, .. }) => {
            let names: Vec<&str> =
                presented.iter().map(|name| name.split_once('(').map_or(name.as_str(), |(_, rest)| rest)).collect();
            let names = names.iter().map(|name| name.trim_end_matches(')').trim_matches('"')).collect::<Vec<_>>();
            format!(
                "{theirs} is not for this name but for {}: connect by one of them, or make one with `isola cert --name`",
                names.join(", ")
            )
        }
        Error::InvalidCertificate(CertificateError::NotValidForName) => {
            format!("{theirs} is not for this name: connect by another one, or make one with `isola cert --name`")
        }
        Error::InvalidCertificate(CertificateError::Expired | CertificateError::ExpiredContext { .. }) => {
            format!("{theirs} has ended: its coordinator needs a new one, from `isola cert`")
        }
        Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature) => {
            format!("{theirs} is of another authority than {AUTHORITY} here")
        }
        Error::InvalidCertificate(
            CertificateError::InvalidPurpose | CertificateError::InvalidPurposeContext { .. },
        ) => format!("{theirs} is not that of a coordinator"),
        Error::InvalidCertificate(reason) => format!("{theirs} is not accepted here: {reason}"),
        Error::AlertReceived(AlertDescription::CertificateExpired) => "it says that this certificate has ended".into(),
        Error::AlertReceived(
            AlertDescription::UnknownCA | AlertDescription::DecryptError | AlertDescription::BadCertificate,
        ) => "it refuses this certificate: of another authority than the one it trusts".into(),
        Error::AlertReceived(alert) => format!("it refuses this certificate: {alert:?}"),
        Error::InvalidMessage(_) => "whoever listens there does not encrypt: write tcp/…".into(),
        other => format!("no encrypted connection is possible: {other}"),
    }
}
