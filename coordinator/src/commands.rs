//! What each command does.

use crate::cli::{Cli, Command, ResumeArgs, ServeArgs, StudyArgs, SweepArgs};
use crate::conduct::{Ending, conduct};
use crate::error::Error;
use crate::place::open;
use crate::rundir::default_directory;
use crate::store::{RunHeader, Store};
use crate::study::{Study, differences};
use crate::{check, outputs, prepare, target};
use clap::CommandFactory;
use protocol::codec::{encode, sha256};
use protocol::ids::RunId;
use protocol::model::ModelMessage;
use std::io::IsTerminal;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// Exit code of a run that ended with tasks missing, and of files, pages and figures that had to leave out what is damaged.
pub const INCOMPLETE: u8 = 3;
/// Exit code of a run that was interrupted.
const INTERRUPTED: u8 = 130;

/// Carries out a command.
///
/// # Errors
/// With one message that says what is wrong and what would be right.
pub fn execute(cli: Cli) -> Result<ExitCode, Error> {
    if !matches!(cli.command, Command::Worker(_)) {
        let filter = EnvFilter::try_from_env("ISOLA_LOG").unwrap_or_else(|_| EnvFilter::new("error,coordinator=warn"));
        tracing_subscriber::fmt()
            .with_env_filter(filter)
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal())
            .init();
    }
    match cli.command {
        Command::Check(args) => {
            print!("{}", check::report(&load(&args)?));
            Ok(ExitCode::SUCCESS)
        }
        Command::Export(args) => outputs::export(&args),
        Command::Report(args) => outputs::report(&args),
        Command::Plot(args) => outputs::plot(&args),
        Command::Completions { shell } => {
            clap_complete::generate(shell, &mut Cli::command(), "isola", &mut std::io::stdout());
            Ok(ExitCode::SUCCESS)
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
        Command::Status(args) => target::status(&args).await.map(|text| print!("{text}")).map(|()| ExitCode::SUCCESS),
        Command::Watch(args) => target::watch(&args).await.map(|()| ExitCode::SUCCESS),
        Command::Cancel(args) => target::cancel(&args).await.map(|text| println!("{text}")).map(|()| ExitCode::SUCCESS),
        Command::RetryDead(args) => {
            target::retry_dead(&args).await.map(|text| println!("{text}")).map(|()| ExitCode::SUCCESS)
        }
        Command::Check(_)
        | Command::Export(_)
        | Command::Report(_)
        | Command::Plot(_)
        | Command::Worker(_)
        | Command::Completions { .. } => {
            unreachable!("carried out without the bus")
        }
    }
}

fn code(ending: Ending) -> ExitCode {
    match ending {
        Ending::Complete => ExitCode::SUCCESS,
        Ending::Incomplete => ExitCode::from(INCOMPLETE),
        Ending::Interrupted => ExitCode::from(INTERRUPTED),
    }
}

fn load(args: &StudyArgs) -> Result<Study, Error> {
    Ok(Study::load(&args.study, &args.set, args.amplitudes.as_deref())?)
}

fn checked(serve: &ServeArgs) -> Result<(), Error> {
    if !(serve.lease.is_finite() && (0.5..=86400.0).contains(&serve.lease)) {
        return Err(Error::Other(format!("--lease {}: use 0.5 to 86400 seconds", serve.lease)));
    }
    if RunId::new(&serve.namespace).is_err() {
        let namespace = &serve.namespace;
        return Err(Error::Other(format!("--namespace {namespace}: use letters, digits, `.`, `-` and `_`")));
    }
    Ok(())
}

async fn sweep(args: SweepArgs) -> Result<Ending, Error> {
    checked(&args.serve)?;
    let study = load(&args.study)?;
    let directory = args.out.unwrap_or_else(|| default_directory(&study.name));
    // What is in use is said before a folder is made.
    let place = open(&args.serve).await?;
    let header = header(&study, &args.study, &args.serve)?;
    let store = Store::create(&directory, &header)?;
    eprintln!("run {} in {}", header.run, directory.display());
    conduct(&directory, store, study.model, place, args.serve).await
}

fn header(study: &Study, args: &StudyArgs, serve: &ServeArgs) -> Result<RunHeader, Error> {
    let id = uuid::Uuid::new_v4().simple().to_string();
    let model = ModelMessage::from(&study.model);
    let mut overrides = args.set.clone();
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
        amplitudes: study.amplitudes.clone(),
        program: protocol::PROGRAM.into(),
        created: jiff::Timestamp::now().to_string(),
        namespace: serve.namespace.clone(),
    })
}

async fn resume(args: ResumeArgs) -> Result<Ending, Error> {
    checked(&args.serve)?;
    let store = Store::open(&args.run)?;
    let header = store.header()?;
    if !args.as_started {
        unchanged(&header)?;
    }
    let model = prepare::model(&store)?;
    let serve = ServeArgs { namespace: header.namespace.clone(), ..args.serve };
    let place = open(&serve).await?;
    eprintln!("run {} in {}", header.run, args.run.display());
    conduct(&args.run, store, model, place, serve).await
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
