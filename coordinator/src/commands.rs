//! What each command does.

use crate::cli::{
    Cli, Command, DisturbArgs, ExtendArgs, ORDERS, RemoteArgs, ResumeArgs, SchemaArgs, ServeArgs, StudyArgs, SweepArgs,
    VerifyArgs,
};
use crate::error::Error;
use crate::run::directory::{default_directory, discard, refuse_foreign};
use crate::run::endpoint::{Connection, open};
use crate::run::{Ending, drive, preparation};
use crate::study::{Study, StudyError, levels};
use crate::{certificates, check, exit, extension, outputs, reference, remote, watch};
use clap::CommandFactory;
use protocol::codec::{encode, sha256};
use protocol::ids::RunId;
use protocol::model::ModelMessage;
use protocol::to_everyone::Stage;
use results::journal::Change;
use results::resolved_study::differences;
use results::store::{RunHeader, Store, network_file_system};
use solver::response::orders::Orders;
use solver::settings::VerifyEffort;
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;
use worker::terminal;

/// Carries out a command.
///
/// # Errors
/// With one message that says what is wrong and what would be right.
pub fn execute(cli: Cli) -> Result<ExitCode, Error> {
    let format = cli.command.serving().map(|serve| serve.log_format).unwrap_or_default();
    if !matches!(cli.command, Command::Worker(_)) {
        // Of health there is one line to say.
        let is_health = matches!(cli.command, Command::Health(_));
        worker::log::start(format, if is_health { "off" } else { "error,coordinator=warn" });
    }
    match cli.command {
        Command::New(args) => {
            args.template.write(&args.folder)?;
            show(args.template.told(&args.folder))
        }
        Command::Schema(args) => schema(&args),
        Command::Cert(args) => show(certificates::make(&args)?),
        Command::Check(args) => checked(&load(&args.study, &args.study.changes(args.units))?),
        Command::Export(args) => outputs::export(&args),
        #[cfg(feature = "page")]
        Command::Report(args) => outputs::report(&args),
        #[cfg(feature = "figures")]
        Command::Plot(args) => outputs::plot(&args),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "isola", &mut script);
            show(String::from_utf8_lossy(&script))
        }
        Command::Worker(options) => Ok(worker::run(&options)),
        command => {
            let mut runtime = tokio::runtime::Builder::new_multi_thread();
            let runtime = runtime.worker_threads(2).enable_all().build().map_err(Error::io("runtime"))?;
            let code = runtime.block_on(on_the_bus(command));
            // Answers to somebody frozen may still wait for room.
            runtime.shutdown_background();
            code
        }
    }
}

async fn on_the_bus(command: Command) -> Result<ExitCode, Error> {
    match command {
        Command::Sweep(args) => sweep(args).await.map(code),
        Command::Resume(args) => resume(args).await.map(code),
        Command::Extend(args) => extend(args).await.map(code),
        Command::Verify(args) => verify(args).await.map(code),
        Command::Disturb(args) => disturb(args).await.map(code),
        Command::Status(args) => show(remote::status(&args).await?),
        Command::Health(args) => Ok(health(&args).await),
        Command::Watch(args) => watch::watch(&args).await.map(|()| ExitCode::SUCCESS),
        Command::Cancel(args) => show(remote::cancel(&args).await? + "\n"),
        Command::RetryDead(args) => show(remote::retry_dead(&args).await? + "\n"),
        _ => unreachable!("carried out without the bus"),
    }
}

/// Whether a run is carried on: one line in any case.
async fn health(args: &RemoteArgs) -> ExitCode {
    match remote::health(args).await {
        // Whoever asks may not read.
        Ok(line) => show(line + "\n").unwrap_or(ExitCode::SUCCESS),
        Err(error) => {
            let reason = error.to_string().replace('\n', " ");
            terminal::note(format_args!("unhealthy: {reason}"));
            ExitCode::from(exit::ERROR)
        }
    }
}

/// The schema of a file, or the meaning of a key or of all keys.
fn schema(args: &SchemaArgs) -> Result<ExitCode, Error> {
    match &args.explain {
        _ if args.all => show(reference::document()),
        _ if args.columns => show(results::export::COLUMNS),
        Some(key) => show(reference::explain(key).map_err(Error::Usage)?),
        None => show(format_args!("{:#}\n", reference::schema(args.file))),
    }
}

/// Shows what a study holds.
///
/// # Errors
/// If that cannot be written, and if no sweep of it can begin.
fn checked(study: &Study) -> Result<ExitCode, Error> {
    let shown = show(check::report(study))?;
    check::without_backbone(&study.model, &study.settings).map_or(Ok(shown), |why| Err(Error::NoBackbone(why)))
}

/// Writes what a command was asked for.
fn show(text: impl Display) -> Result<ExitCode, Error> {
    terminal::print(text).map_err(Error::io("standard output"))?;
    Ok(ExitCode::SUCCESS)
}

fn code(ending: Ending) -> ExitCode {
    match ending {
        Ending::Complete => ExitCode::SUCCESS,
        Ending::Doubtful => ExitCode::from(exit::DOUBTFUL),
        Ending::Incomplete => ExitCode::from(exit::INCOMPLETE),
        Ending::Interrupted => ExitCode::from(exit::INTERRUPTED),
    }
}

fn load(args: &StudyArgs, changes: &[(String, String)]) -> Result<Study, Error> {
    let orders =
        args.orders.as_deref().map(|orders| (format!("--set {ORDERS}={orders}"), format!("--orders {orders}")));
    Study::load(&args.study, changes, args.amplitudes.as_deref()).map_err(|error| match (error, orders) {
        // Blamed is the option that was typed.
        (StudyError::Refused(refused), Some((set, typed))) => StudyError::Refused(refused.retyped(&set, &typed)).into(),
        (error, _) => error.into(),
    })
}

async fn sweep(args: SweepArgs) -> Result<Ending, Error> {
    let changes = args.study.changes(args.serve.units);
    let study = load(&args.study, &changes)?;
    for key in &study.without_effect {
        terminal::note(format_args!("{key} has no effect any more: branches close by convergence"));
    }
    for warning in check::warnings_of_sweep(&study) {
        terminal::note(format_args!("warning: {warning}"));
    }
    for note in check::notes_of_sweep(&study) {
        terminal::note(format_args!("note: {note}"));
    }
    let directory = args.out.unwrap_or_else(|| default_directory(&study.name));
    refuse_foreign(&directory, &study.file)?;
    // What is in use is said before a folder is made.
    let connection = open(&args.serve, None).await?;
    let header = header(&study, changes, &args.study, &args.serve)?;
    let is_new = !directory.exists();
    let store = Store::create(&directory, &header)?;
    announce(&header, &directory);
    let ended = drive(&directory, store, study.model, connection, args.serve, false).await;
    if ended.as_ref().is_err_and(Error::is_of_study) {
        // There is nothing to go on with, and whoever mends the study may want the same folder.
        discard(&directory, is_new);
    }
    ended
}

fn header(
    study: &Study,
    changes: Vec<(String, String)>,
    args: &StudyArgs,
    serve: &ServeArgs,
) -> Result<RunHeader, Error> {
    let id = uuid::Uuid::new_v4().simple().to_string();
    let model = ModelMessage::from(&study.model);
    let mut overrides = changes;
    overrides.extend(args.amplitudes.iter().map(|list| ("amplitudes".to_string(), list.clone())));
    Ok(RunHeader {
        run: RunId::new(&id[..12]).map_err(|error| Error::Other(error.to_string()))?,
        name: study.name.clone(),
        study_file: std::path::absolute(&study.file).map_err(Error::io(&study.file))?,
        overrides,
        study: study.resolved.clone(),
        model_sha256: sha256(&encode(&model)),
        model,
        settings: study.settings,
        amplitudes: levels(&study.amplitudes, &Orders::of(&study.model, &study.settings)),
        program: protocol::PROGRAM.into(),
        created: results::clock::now(),
        namespace: serve.namespace.clone(),
    })
}

async fn resume(args: ResumeArgs) -> Result<Ending, Error> {
    let store = Store::open(&args.run)?;
    if !args.as_started {
        unchanged(&store.header()?)?;
    }
    let connection = reopen(&store, &args.run, &args.serve).await?;
    go_on(&args.run, store, connection, args.serve).await
}

async fn extend(args: ExtendArgs) -> Result<Ending, Error> {
    let mut store = Store::open(&args.run)?;
    let header = store.header()?;
    let levels = extension::new_levels(&header, &args.amplitudes)?;
    if !args.as_started {
        unchanged(&header)?;
    }
    let connection = reopen(&store, &args.run, &args.serve).await?;
    let model = preparation::model(&store)?;
    extension::add(&mut store, &model, levels)?;
    go_on(&args.run, store, connection, args.serve).await
}

async fn verify(args: VerifyArgs) -> Result<Ending, Error> {
    let mut store = Store::open(&args.run)?;
    // What else the run has left to do is done as well: by the study that it began with.
    if !args.as_started && store.stage()? != Stage::Finished {
        unchanged(&store.header()?)?;
    }
    let connection = reopen(&store, &args.run, &args.serve).await?;
    store.set_verify(args.effort)?;
    go_on(&args.run, store, connection, args.serve).await
}

async fn disturb(args: DisturbArgs) -> Result<Ending, Error> {
    let mut store = Store::open(&args.run)?;
    let is_finished = store.stage()? == Stage::Finished;
    if !args.as_started && !is_finished {
        unchanged(&store.header()?)?;
    }
    announce(&store.header()?, &args.run);
    if !is_finished || store.unverified_isolas()? > 0 {
        terminal::note("what the run has left to do comes first, and which parts of its isolas are stable");
        let connection = reopen(&store, &args.run, &args.serve).await?;
        if store.header()?.settings.verify.effort == VerifyEffort::None {
            store.set_verify(VerifyEffort::Standard)?;
        }
        match carry_out(&args.run, store, connection, args.serve.clone(), true).await? {
            Ending::Complete | Ending::Doubtful => {}
            ending => return Ok(ending),
        }
        store = Store::open(&args.run)?;
    }
    let modes = store.model()?.model().map_err(|error| Error::Other(format!("the stored model: {error}")))?.size();
    let connection = reopen(&store, &args.run, &args.serve).await?;
    let pushes = store.pushes_left(modes.min(args.modes.into()))?;
    if pushes.is_empty() {
        let why = match (store.isolas()?.is_empty(), store.pushes()?.is_empty()) {
            (true, _) => "no isola was found: there is nothing to be pushed onto",
            (_, false) => "nothing is left to be pushed: every isola that can be settled on was, in these modes",
            _ => {
                "nothing is left to be pushed: of no isola a part is known to be stable, and only on such a motion settles"
            }
        };
        terminal::note(why);
    }
    store.commit(&[Change::Added(pushes)])?;
    carry_out(&args.run, store, connection, args.serve, false).await
}

/// Opens the bus in the namespace that a run began in.
async fn reopen(store: &Store, directory: &Path, serve: &ServeArgs) -> Result<Connection, Error> {
    open(&ServeArgs { namespace: store.header()?.namespace, ..serve.clone() }, Some(directory)).await
}

/// Says where a run is, and does what it has left to do.
async fn go_on(directory: &Path, store: Store, connection: Connection, serve: ServeArgs) -> Result<Ending, Error> {
    announce(&store.header()?, directory);
    carry_out(directory, store, connection, serve, false).await
}

/// Does what a run has left to do; `is_followed`: the command does more with it.
async fn carry_out(
    directory: &Path,
    store: Store,
    connection: Connection,
    serve: ServeArgs,
    is_followed: bool,
) -> Result<Ending, Error> {
    let model = preparation::model(&store)?;
    let serve = ServeArgs { namespace: store.header()?.namespace, ..serve };
    drive(directory, store, model, connection, serve, is_followed).await
}

/// Says where the run is, and what it lies on if that matters.
fn announce(header: &RunHeader, directory: &Path) {
    terminal::note(format_args!("run {} in {}", header.run, directory.display()));
    if let Some(system) = network_file_system(directory) {
        terminal::note(format_args!(
            "{} is on a network file system ({system}): while the run goes on read its database on this machine only, elsewhere \
             use `isola status` and `isola watch` with --connect; --out names a folder on a local disk, which is faster too",
            directory.display()
        ));
    }
}

/// Refuses to go on with a study whose file or model has changed since.
fn unchanged(header: &RunHeader) -> Result<(), Error> {
    let file = header.study_file.display();
    let remedy = "start a new run with `isola sweep`, or go on with the study as it was: add --as-started";
    let study = Study::load(&header.study_file, &header.overrides, None)
        .map_err(|error| Error::Other(format!("{error}\nthe study of this run cannot be read any more; {remedy}")))?;
    let changes = differences(&header.study, &study.resolved);
    let list: Vec<String> =
        changes.iter().map(|change| format!("\n  {} was {}, is {}", change.key, change.old, change.new)).collect();
    if !list.is_empty() {
        let list = list.concat();
        return Err(Error::Other(format!("{file} has changed since the run began:{list}\n{remedy}")));
    }
    if sha256(&encode(&ModelMessage::from(&study.model))) != header.model_sha256 {
        return Err(Error::Other(format!("the model of {file} has changed since the run began; {remedy}")));
    }
    Ok(())
}
