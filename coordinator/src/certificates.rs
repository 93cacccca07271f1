//! Certificates for encrypted connections: an authority of one's own, and what it gives to coordinator, operators, workers and viewers.

use crate::cli::CertArgs;
use crate::error::Error;
use protocol::certificate::{AUTHORITY, CERTIFICATE, KEY};
use protocol::role::Role;
use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use std::fmt::Write as _;
use std::io::Write as _;
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::Path;
use time::{Duration, OffsetDateTime};

/// The key of the authority, which stays where it was made.
const AUTHORITY_KEY: &str = "ca.key";
/// How long an authority is trusted.
const AUTHORITY_DAYS: i64 = 3650;
/// Clocks of other machines may be late by so much.
const CLOCKS: Duration = Duration::hours(1);

/// From when to when a certificate is accepted.
#[derive(Debug, Clone, Copy)]
pub struct Validity {
    /// First moment.
    pub begins: OffsetDateTime,
    /// Last one.
    pub ends: OffsetDateTime,
}

impl Validity {
    /// From now on, for so many days.
    pub fn days(days: i64) -> Self {
        let now = OffsetDateTime::now_utc();
        Self { begins: now - CLOCKS, ends: now + Duration::days(days) }
    }
}

/// Who gives certificates.
pub struct Authority {
    issuer: Issuer<'static, KeyPair>,
    certificate: String,
    key: String,
}

/// What one side needs, in PEM format.
pub struct Issued {
    /// Its certificate.
    pub certificate: String,
    /// The key to it.
    pub key: String,
}

fn named(name: &str, names: &[String], Validity { begins, ends }: Validity) -> Result<CertificateParams, rcgen::Error> {
    let mut params = CertificateParams::new(names)?;
    params.distinguished_name = DistinguishedName::new();
    params.distinguished_name.push(DnType::CommonName, name);
    (params.not_before, params.not_after) = (begins, ends);
    Ok(params)
}

impl Authority {
    /// A new one.
    ///
    /// # Errors
    /// If there is no randomness.
    pub fn new(validity: Validity) -> Result<Self, rcgen::Error> {
        // Not that of another one, by which it would be taken for that.
        let name = format!("Isola {}", &uuid::Uuid::new_v4().simple().to_string()[..8]);
        let mut params = named(&name, &[], validity)?;
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
        let key = KeyPair::generate()?;
        let (certificate, text) = (params.self_signed(&key)?.pem(), key.serialize_pem());
        Ok(Self { issuer: Issuer::new(params, key), certificate, key: text })
    }

    fn read(folder: &Path) -> Result<Self, Error> {
        let text = |name| {
            let file = folder.join(name);
            std::fs::read_to_string(&file).map_err(Error::io(file))
        };
        let (certificate, key) = (text(AUTHORITY)?, text(AUTHORITY_KEY)?);
        let issuer = KeyPair::from_pem(&key).and_then(|key| Issuer::from_ca_cert_pem(&certificate, key));
        let issuer = issuer.map_err(|error| Error::Other(format!("{}: {error}", folder.join(AUTHORITY).display())))?;
        Ok(Self { issuer, certificate, key })
    }

    /// In PEM format, for whoever is to trust it.
    pub fn certificate(&self) -> &str {
        &self.certificate
    }

    /// A certificate of a role; of a coordinator with the names and addresses by which others connect.
    ///
    /// # Errors
    /// If a name is none.
    pub fn issue(&self, role: Role, names: &[String], validity: Validity) -> Result<Issued, rcgen::Error> {
        let mut params = named(role.common_name(), names, validity)?;
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ClientAuth];
        if role == Role::Coordinator {
            params.extended_key_usages.push(ExtendedKeyUsagePurpose::ServerAuth);
        }
        params.use_authority_key_identifier_extension = true;
        let key = KeyPair::generate()?;
        Ok(Issued { certificate: params.signed_by(&key, &self.issuer)?.pem(), key: key.serialize_pem() })
    }
}

/// Writes what one side needs into a new folder; the key is for its owner alone.
///
/// # Errors
/// If the folder is there already or cannot be written.
pub fn write(folder: &Path, authority: &str, issued: &Issued) -> Result<(), Error> {
    std::fs::DirBuilder::new().mode(0o700).create(folder).map_err(Error::io(folder))?;
    write_new(&folder.join(AUTHORITY), authority, 0o644)?;
    write_new(&folder.join(CERTIFICATE), &issued.certificate, 0o644)?;
    write_new(&folder.join(KEY), &issued.key, 0o600)
}

fn write_new(file: &Path, text: &str, mode: u32) -> Result<(), Error> {
    let open = std::fs::OpenOptions::new().write(true).create_new(true).mode(mode).open(file);
    open.and_then(|mut opened| opened.write_all(text.as_bytes())).map_err(Error::io(file))
}

/// Makes the certificates that a folder does not have yet, and the authority that gives them; says what there is and what to do
/// with it.
///
/// # Errors
/// If something cannot be read or written, or would have to be overwritten.
pub fn make(args: &CertArgs) -> Result<String, Error> {
    let folder = args.folder.as_path();
    let of_rcgen = |error: rcgen::Error| Error::Other(format!("no certificate can be made: {error}"));
    std::fs::DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(Error::io(folder))?;
    let mut told = String::new();
    let mut tell = |line: std::fmt::Arguments<'_>| writeln!(told, "{line}").expect("a text can be written to");
    let authority = if folder.join(AUTHORITY).exists() || folder.join(AUTHORITY_KEY).exists() {
        tell(format_args!("{}: the authority that was there", folder.join(AUTHORITY).display()));
        Authority::read(folder)?
    } else {
        let validity = Validity::days(AUTHORITY_DAYS);
        let authority = Authority::new(validity).map_err(of_rcgen)?;
        write_new(&folder.join(AUTHORITY_KEY), &authority.key, 0o600)?;
        write_new(&folder.join(AUTHORITY), &authority.certificate, 0o644)?;
        tell(format_args!("{}: an authority, until {}", folder.join(AUTHORITY).display(), validity.ends.date()));
        authority
    };
    if !args.names.is_empty() && folder.join(Role::Coordinator.name()).exists() {
        let theirs = folder.join(Role::Coordinator.name());
        return Err(Error::Usage(format!(
            "{} is there already: move it away for one with other names",
            theirs.display()
        )));
    }
    let mut names = vec!["localhost".to_string(), "127.0.0.1".into(), "::1".into(), worker::host_name()];
    names.extend(args.names.iter().cloned());
    names = names.iter().enumerate().filter(|(i, name)| !names[..*i].contains(name)).map(|(_, n)| n.clone()).collect();
    for role in Role::ALL {
        let own = folder.join(role.name());
        if own.exists() {
            tell(format_args!("{}: was there already and stays as it is", own.display()));
            continue;
        }
        let (names, is_for) = match role {
            Role::Coordinator => (names.as_slice(), format!(", for {}", names.join(", "))),
            Role::Operator | Role::Worker | Role::Viewer => (&[][..], String::new()),
        };
        let validity = Validity::days(args.days);
        let issued = authority.issue(role, names, validity).map_err(of_rcgen)?;
        write(&own, &authority.certificate, &issued)?;
        tell(format_args!("{}: of {}{is_for}, until {}", own.display(), role.with_article(), validity.ends.date()));
    }
    let (folder, key) = (folder.display(), folder.join(AUTHORITY_KEY));
    tell(format_args!(
        "
{key} makes further certificates: leave it here, and give each side its own folder alone.
  isola sweep STUDY --listen tls/0.0.0.0:7447 --tls {folder}/coordinator --workers 0
  isola worker --connect tls/HOST:7447 --tls worker --secret-file secret
  isola watch --connect tls/HOST:7447 --tls viewer --secret-file secret
  isola cancel --connect tls/HOST:7447 --tls operator --secret-file secret
HOST is one of the names of the coordinator (--name), and `secret` a copy of the file in the folder of the run. For a new certificate
move the folder of the old one away and repeat this command.",
        key = key.display()
    ));
    Ok(told)
}
