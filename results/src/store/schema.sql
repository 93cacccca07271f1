-- A run of Isola. SI units: rad/s, m, N, J; forcing amplitudes A in the model's unit of forcing.
-- `pragma application_id` is 0x49534F4C ("ISOL"), `pragma user_version` the version of this schema.
--
-- Arrays are BLOBs of little-endian 64-bit floating point numbers, row-major:
--   numpy.frombuffer(data, dtype).reshape(json.loads(shape))
-- "msgpack" marks BLOBs for the program itself; what they say stands in other columns in readable form.
-- NULL in a column of numbers: not a number.

-- What holds for the whole run.
CREATE TABLE meta (
    -- run, name, study_file, overrides (of the command line, JSON), study (TOML, every setting spelled out), model_sha256, program, created (RFC 3339, UTC),
    -- namespace (of the keys on the bus), stage (backbone, sweep, finished, cancelled), settings (msgpack),
    -- verify (msgpack: what is verified, if that was changed after the run began);
    -- once levels were added: other_bounds (sequence of the last result from before, within other bounds),
    -- with the backbones: omega_low, omega_high, amplitude_bound (reach of branches), backbone_status (of the primary mode),
    -- reach and backbone (msgpack), and where several orders of motions are looked for orders (msgpack: reach and backbones of all but
    -- the first);
    -- said/TASK/ATTEMPT (msgpack): what an attempt says of a task that others disagree on.
    key TEXT NOT NULL PRIMARY KEY,
    value NOT NULL
) WITHOUT ROWID;

-- The model, one row. Its matrices are in `arrays`, owner 'model': mass, stiffness, frequencies, shapes (a column per
-- mode: x = shapes y), damping, forcing.
CREATE TABLE model (
    -- Name shown to people.
    name TEXT NOT NULL,
    -- Names of all dofs, JSON.
    dofs TEXT NOT NULL,
    -- Names of the monitored dofs, JSON: second axis of the arrays `amplitude` and `rms`.
    monitors TEXT NOT NULL,
    -- Names of the nonlinear and monitored dofs, JSON: second axis of the arrays `displacement`.
    displacement_dofs TEXT NOT NULL,
    -- Names of the contact elements, JSON: second axis of the arrays `contact`.
    contacts TEXT NOT NULL,
    -- The `model` message, msgpack.
    payload BLOB NOT NULL
);

-- Forcing levels, in the order of the study.
CREATE TABLE levels (
    -- Number, from 1.
    level INTEGER NOT NULL PRIMARY KEY,
    -- Name: the forcing amplitude as typed, and behind it the order of the motions where that is not the study's first: '60-m3'.
    amplitude TEXT NOT NULL UNIQUE,
    -- Forcing amplitude.
    value REAL NOT NULL
);

-- Modes of the structure: which were followed, and why others were not.
CREATE TABLE modes (
    -- Mode, from 1.
    mode INTEGER NOT NULL PRIMARY KEY,
    -- Place among the modes followed: 0 for the primary one; NULL: it was not followed.
    place INTEGER,
    -- How its backbone ends, or why it was not followed, in words.
    outcome TEXT NOT NULL,
    -- The same, msgpack: of a mode followed its backbone without numbers.
    record BLOB NOT NULL
);

-- Points of the backbones. Arrays of the primary mode's are in `arrays`, owner 'backbone'; of mode 2, owner 'backbone/2'.
CREATE TABLE backbone (
    -- Mode, from 1.
    mode INTEGER NOT NULL,
    -- Number of the point, from 0.
    i INTEGER NOT NULL,
    -- Frequency.
    omega REAL,
    -- Decay rate, 1/s.
    zeta REAL,
    {columns of points},
    {columns of the backbone},
    PRIMARY KEY (mode, i)
) WITHOUT ROWID;

-- Windows: where along a backbone a level is predicted to have forced responses.
CREATE TABLE windows (
    -- Level.
    level INTEGER NOT NULL REFERENCES levels (level),
    -- Number within the level, from 1: backbone by backbone, in their order.
    window INTEGER NOT NULL,
    -- Mode of the backbone, from 1.
    mode INTEGER NOT NULL,
    -- Lowest and highest frequency.
    omega_min REAL NOT NULL,
    omega_max REAL NOT NULL,
    -- Frequency of the point of smallest threshold.
    omega_best REAL NOT NULL,
    -- Smallest threshold A*.
    threshold REAL NOT NULL,
    -- Points of the backbone: first and last inside, and the one of smallest threshold.
    first INTEGER NOT NULL,
    last INTEGER NOT NULL,
    best INTEGER NOT NULL,
    PRIMARY KEY (level, window)
) WITHOUT ROWID;

-- Tasks: each lands a seed, or continues one branch or one curve over the forcing at most, or verifies a branch.
CREATE TABLE tasks (
    -- Name.
    id TEXT NOT NULL PRIMARY KEY,
    -- Level; of a 'fold' and a 'carry' the one that its curve starts from; of a 'scout', and of the folds that it met, the largest then.
    level INTEGER NOT NULL REFERENCES levels (level),
    -- Turn within the level, from 0; of a 'verify', a 'disturb' and a 'march' the turn among all of its kind, of a 'fold' and a 'carry' among all of both.
    position INTEGER NOT NULL,
    -- 'carry' (follows a response of an open branch over the forcing at fixed frequency),
    -- 'switch' (from a branch point of a branch onto what crosses it there),
    -- 'main' (from a frequency bound), 'land' (lands a seed of a window), 'seed' (from what a seed landed on), 'fold'
    -- (follows a fold of a branch over the forcing), 'crossing' (from where a curve crosses the level), 'start' (a
    -- batch of random starts), 'begin' (from what they led to), 'scout' (random starts beyond the forcing amplitudes of
    -- the study, for the folds of what they lead to), 'verify' (the stability of a branch, by time marching) or
    -- 'disturb' (pushes that may end on a branch, by time marching) or 'march' (what an unstable motion turns into).
    kind TEXT NOT NULL,
    -- What it follows from, if not a window: 'isola 1, fold 2', 'scout 1, fold 2', 'curve 3' or 'starts, batch 1'; of a 'verify' the branch, of
    -- a 'disturb' with the mode, of a 'march' with the point.
    origin TEXT,
    -- Window the seed is from; NULL unless 'land' or 'seed', as the next two.
    window INTEGER,
    -- 'first' or 'second': which of the two phases.
    phase TEXT,
    -- 'fixed_frequency' or 'stepped_forcing': how the seed is landed.
    way TEXT,
    -- 'waiting', 'leased', 'done', 'skipped' (not needed any more) or 'dead' (given up).
    state TEXT NOT NULL DEFAULT 'waiting',
    -- How often it was handed out.
    attempts INTEGER NOT NULL DEFAULT 0,
    -- Attempts up to this one do not count as failures: it was taken from the dead list after it.
    forgiven INTEGER NOT NULL DEFAULT 0,
    -- What became of it, in words; NULL unless done.
    outcome TEXT,
    -- Whether it lies on a branch or, of a 'fold' or a 'carry', on a curve, or whether it landed or marched; NULL unless done.
    found INTEGER,
    -- That branch, 'main' or 'isola 1', …; NULL unless found.
    branch TEXT,
    -- What is to be done, msgpack.
    work BLOB NOT NULL,
    -- What became of it, msgpack.
    record BLOB
);
CREATE UNIQUE INDEX turns ON tasks (level, position) WHERE kind NOT IN ('fold', 'carry', 'verify', 'disturb', 'march');
-- What is told level by level is looked up so.
CREATE INDEX tasks_of_level ON tasks (level);

-- Every time a task was handed out.
CREATE TABLE attempts (
    -- Task.
    task TEXT NOT NULL REFERENCES tasks (id),
    -- Counts from 1 for each task.
    attempt INTEGER NOT NULL,
    -- To whom.
    worker TEXT NOT NULL,
    -- To which of its computing threads, from 0.
    slot INTEGER NOT NULL,
    -- When, RFC 3339, UTC, to the ms.
    granted_at TEXT NOT NULL,
    -- When it ended; NULL while it is under way.
    ended_at TEXT,
    -- 'done', 'failed', 'refused' (its result cannot be true), 'expired' (no sign of life; a result may have come all the same:
    -- see `results`), 'released' (given back) or 'superseded' (another result came first). Some tasks that brought no curve are handed
    -- out once more when they are done: 'confirmed' (it came to the same) or 'disputed' (to something else). What two others
    -- contradict is 'refuted': the result is taken out of `results` and the task done again, unless others were built on it: if it still
    -- is the attempt of `results`, what is stored is wrong.
    "end" TEXT,
    -- Why, if it failed, was refused, disputed or refuted, or expired.
    reason TEXT,
    -- How often there was no sign of life in time, and then it was heard of again before anybody else was given the task.
    lapses INTEGER NOT NULL DEFAULT 0,
    -- Steps of attempts before it that it began with.
    checkpoint INTEGER NOT NULL DEFAULT 0,
    PRIMARY KEY (task, attempt)
) WITHOUT ROWID;

-- Steps along branches and curves under way, in parts as they come in, so that whoever is handed a task next goes on from them;
-- none of tasks that are done.
CREATE TABLE checkpoints (
    -- Task.
    task TEXT NOT NULL REFERENCES tasks (id),
    -- Number of the first step of this part, from 0.
    first INTEGER NOT NULL,
    -- Number of steps.
    steps INTEGER NOT NULL,
    -- Attempt that took them.
    attempt INTEGER NOT NULL,
    -- The steps, msgpack.
    payload BLOB NOT NULL,
    PRIMARY KEY (task, first)
);

-- Results accepted, one a task at most, with and without a branch.
CREATE TABLE results (
    -- Number of the announcement, from 1.
    sequence INTEGER NOT NULL PRIMARY KEY,
    -- Task.
    task TEXT NOT NULL UNIQUE REFERENCES tasks (id),
    -- Attempt that it is from.
    attempt INTEGER NOT NULL,
    -- Who computed it.
    worker TEXT NOT NULL,
    -- With which version of the program.
    program TEXT NOT NULL,
    -- Computing time, s.
    seconds REAL,
    -- Size of the `result` message, bytes.
    size INTEGER NOT NULL,
    -- Its SHA-256.
    sha256 TEXT NOT NULL,
    -- The `result` message without the numbers of its arrays, msgpack.
    record BLOB NOT NULL
);

-- Branches. Who computed one and when: `results` and `attempts` of its task. Its arrays: `arrays`, owner = task.
CREATE TABLE branches (
    -- Number of the branch in this file.
    id INTEGER NOT NULL PRIMARY KEY,
    -- Task that found it.
    task TEXT NOT NULL UNIQUE REFERENCES results (task),
    -- Level.
    level INTEGER NOT NULL REFERENCES levels (level),
    -- Forcing amplitude as typed.
    amplitude TEXT NOT NULL,
    -- 'main', 'isola' (closed), 'open' (detached, from frequency bound to frequency bound), 'cut' (at a bound that was
    -- given), 'branched' (branches off others, less symmetric or of a longer period) or 'unfinished'.
    kind TEXT NOT NULL,
    -- Number within level and kind, from 1.
    number INTEGER NOT NULL,
    -- How it ends, in words.
    status TEXT NOT NULL,
    -- Whether it is a closed curve.
    closed INTEGER NOT NULL,
    -- Number of points.
    points INTEGER NOT NULL,
    -- Steps that were refused and repeated shorter.
    rejections INTEGER NOT NULL,
    -- Start, peak and folds, JSON: [{"kind": "fold", "index": 12}, …], index = points.i.
    special TEXT NOT NULL,
    -- Lowest and highest frequency.
    omega_min REAL,
    omega_max REAL,
    -- Largest amplitude of the first monitored dof, and the frequency there.
    amplitude_max REAL,
    omega_at_max REAL,
    -- Lowest and highest frequency at which any contact element touches; NULL if none does.
    contact_omega_min REAL,
    contact_omega_max REAL,
    -- 'at' (a maximum) or 'at_least' (the largest amplitude is only as far as the branch is known).
    peak_standing TEXT,
    -- Largest penetration of a contact over its gap; NULL if it was not computed, as in the next columns.
    penetration REAL,
    -- Largest share (rms) of the contact pressure beyond H.
    pressure_beyond REAL,
    -- The peak converged again with 2 H harmonics: its amplitude, and the relative shift of its frequency.
    amplitude_2h REAL,
    shift_2h REAL,
    -- Lowest and highest frequency of a closed branch with 2 H harmonics.
    omega_min_2h REAL,
    omega_max_2h REAL,
    -- How far the branch moves at most with 2 H harmonics, relative to frequency and amplitude, of points compared, and the frequency there. The
    -- first is NULL where near most of them no motion was found.
    change_2h REAL,
    change_omega_2h REAL,
    -- Slowest sliding of a contact along the rotation while it presses, over the speed of the rotor there; NULL where none with friction presses.
    slowest_sliding REAL,
    UNIQUE (level, kind, number)
);

-- Points of branches, in the order of the arc.
CREATE TABLE points (
    -- Branch.
    branch INTEGER NOT NULL REFERENCES branches (id),
    -- Number of the point, from 0.
    i INTEGER NOT NULL,
    -- Frequency.
    omega REAL,
    {columns of points},
    -- Whether the response is stable, by time marching: as verified_points.verdict; NULL where that is not known.
    stable TEXT,
    -- Largest modulus of the Floquet multipliers, where a marched orbit has this frequency.
    multiplier REAL,
    PRIMARY KEY (branch, i)
) WITHOUT ROWID;

-- Fold curves: the turning points of branches, followed over the forcing amplitude. Their arrays are in the records of their
-- results.
CREATE TABLE curves (
    -- Number, from 1.
    number INTEGER NOT NULL PRIMARY KEY,
    -- Task that found it.
    task TEXT NOT NULL UNIQUE REFERENCES results (task),
    -- 'fold', or 'response': of responses at one frequency.
    kind TEXT NOT NULL,
    -- How it begins and ends, in words.
    status TEXT NOT NULL,
    -- Whether it is a closed curve, which does not repeat its first point.
    closed INTEGER NOT NULL,
    -- Whether it is known only in part: it stalled, or a budget ended it.
    unfinished INTEGER NOT NULL,
    -- Steps that were refused and repeated shorter.
    rejections INTEGER NOT NULL
);

-- Points of curves over the forcing, in the order of the arc.
CREATE TABLE curve_points (
    -- Curve.
    curve INTEGER NOT NULL REFERENCES curves (number),
    -- Number of the point, from 0.
    i INTEGER NOT NULL,
    -- Forcing amplitude, at which a branch turns here or has a response.
    forcing REAL,
    -- Frequency.
    omega REAL,
    -- Amplitude of the first monitored dof.
    amplitude REAL,
    -- 'birth' (an isola appears as the forcing grows), 'death' (it vanishes), 'merge' (two branches become one, or one
    -- two), 'cusp' (two folds of a branch appear or vanish) or 'unknown' (one of these); NULL elsewhere.
    event TEXT,
    -- Forcing amplitude and frequency of a birth, death or merge with twice the harmonics; NULL if it was not found there.
    forcing_2h REAL,
    omega_2h REAL,
    PRIMARY KEY (curve, i)
) WITHOUT ROWID;

-- Verifications: what time marching says of a branch. All numbers are in the records of their results.
CREATE TABLE verifications (
    -- Task that verified it.
    task TEXT NOT NULL PRIMARY KEY REFERENCES results (task),
    -- Branch.
    branch INTEGER NOT NULL REFERENCES branches (id),
    -- 'whole', or 'peak': what is around its peak.
    stretch TEXT NOT NULL,
    -- 'complete', or 'budget': changes of stability may lie between points farther apart than neighbours.
    status TEXT NOT NULL,
    -- Shares of the points of the branch that are known to be stable, and unstable.
    stable REAL NOT NULL,
    unstable REAL NOT NULL,
    -- Number of the point of largest amplitude, = verified_points.i, if it was verified.
    peak INTEGER
) WITHOUT ROWID;
CREATE INDEX verifications_of_branch ON verifications (branch);

-- Points of branches that were verified: the marched orbit near each, and its stability.
CREATE TABLE verified_points (
    -- Task of the verification.
    task TEXT NOT NULL REFERENCES verifications (task),
    -- Number of the point on the branch, = points.i.
    i INTEGER NOT NULL,
    -- Number of the point at which the branch passes the frequency of the orbit: what is true of the orbit is told there.
    at INTEGER NOT NULL,
    -- 'stable', 'unstable', 'marginal' (a multiplier is 1 in modulus as far as it is known, or a push of 1e-4 of the motion leads
    -- away), 'none' (no marched orbit nearby) or
    -- 'not_comparable' (marching loses impact energy that the balance keeps).
    verdict TEXT NOT NULL,
    -- Why there is no verdict, in words.
    reason TEXT,
    -- Frequency of the orbit; NULL without one, as in the next columns.
    omega REAL,
    -- Its largest |x| of the first monitored dof.
    amplitude REAL,
    -- Its distance from the point, rms over a period relative to the motion there.
    distance REAL,
    -- Its largest Floquet multiplier.
    re REAL,
    im REAL,
    -- Share of the energy supplied in a period that impacts take.
    impacts REAL,
    PRIMARY KEY (task, i)
) WITHOUT ROWID;

-- Bifurcations of marched orbits, where a multiplier crosses the unit circle.
CREATE TABLE bifurcations (
    -- Task of the verification.
    task TEXT NOT NULL REFERENCES verifications (task),
    -- Number along the branch, from 1.
    number INTEGER NOT NULL,
    -- 'fold', 'period_doubling', 'neimark_sacker', 'branch_point' (other responses of the same period branch off, or the branch itself does) or 'grazing'
    -- (multipliers jump where a contact is grazed).
    kind TEXT NOT NULL,
    -- Marched frequency.
    omega REAL NOT NULL,
    -- Largest |x| of the first monitored dof of the orbit.
    amplitude REAL,
    -- Number of the point at which the branch passes this frequency, = points.i.
    at INTEGER NOT NULL,
    -- Multipliers outside the unit circle before and after it.
    before INTEGER NOT NULL,
    after INTEGER NOT NULL,
    PRIMARY KEY (task, number)
) WITHOUT ROWID;

-- Arrays of the model, of the backbone and of branches. p points, H harmonics; harmonics X_k are complex, axes
-- (H + 1) x 2, the last one (re, im): x(t) = Re sum X_k exp(i k omega t).
--   argument       p x channels x (H + 1) x 2: arguments of the laws (contact normals: predicted pressure, N; else m)
--   modal          p x modes x (H + 1) x 2: modal amplitudes, kg^0.5 m
--   displacement   p x dofs x (H + 1) x 2: displacements of the dofs named in model.displacement_dofs, m
--   decay, forcing p: decay rate, 1/s (a column of `backbone`), and forcing amplitude A
{arrays}
-- Columns of `points` and `backbone` that hold a number of their own are not repeated here, unless they cannot hold it
-- (NaN, -0).
CREATE TABLE arrays (
    -- 'model', 'backbone' (of a further mode 'backbone/2', …) or the task of a branch.
    owner TEXT NOT NULL,
    -- Name.
    name TEXT NOT NULL,
    -- '<f8'.
    dtype TEXT NOT NULL,
    -- Lengths of the axes, JSON.
    shape TEXT NOT NULL,
    -- The numbers.
    data BLOB NOT NULL,
    UNIQUE (owner, name)
);

-- Pushes from the main motion of a level in one mode each: the smallest found that ends on a branch.
CREATE TABLE pushes (
    -- Task that marched them.
    task TEXT NOT NULL PRIMARY KEY REFERENCES results (task),
    -- Branch.
    branch INTEGER NOT NULL REFERENCES branches (id),
    -- Number of the mode, from 1.
    mode INTEGER NOT NULL,
    -- Frequency of both motions.
    omega REAL NOT NULL,
    -- Number of the monitored dof that the mode moves most, from 0: impulses are those that act there.
    monitor INTEGER NOT NULL,
    -- Motions that were marched in the scan.
    motions INTEGER NOT NULL,
    -- The largest impulse that was scanned, N s.
    largest REAL,
    -- The smallest impulse found that ends on the branch, N s; NULL if none does, as in the next columns.
    impulse REAL,
    -- The largest smaller one at this phase that was seen not to.
    below REAL,
    -- What it changes the velocity of the dof by, m/s.
    velocity REAL,
    -- When it acts, as a share of the period from where the forcing is largest.
    phase REAL,
    -- 1 if both were marched until they were beyond doubt where they end.
    confirmed INTEGER,
    -- Why nothing was scanned, in words.
    reason TEXT,
    -- Where the motion ends that begins when the forcing is switched on at rest: 'onto' the branch, 'back' on the motion that pushes
    -- begin from, 'elsewhere'; NULL if neither motion is known.
    from_rest TEXT
) WITHOUT ROWID;

-- What unstable motions of branches turn into, by time marching.
CREATE TABLE motions (
    -- Task that marched it.
    task TEXT NOT NULL PRIMARY KEY REFERENCES results (task),
    -- Branch.
    branch INTEGER NOT NULL REFERENCES branches (id),
    -- Number of the point that it was marched from, = points.i.
    i INTEGER NOT NULL,
    -- Frequency.
    omega REAL NOT NULL,
    -- 'periodic', 'quasi_periodic', 'chaotic' (small deviations grow) or 'unclear'.
    motion TEXT NOT NULL,
    -- Periods of the response after which it repeats itself; NULL if it does not.
    repeats INTEGER,
    -- Name of the branch of the level whose marched orbit it is; NULL if it is none of those found.
    onto TEXT,
    -- Smallest and largest of the largest |x| of the first monitored dof in a period; NULL if it could not be marched.
    amplitude_min REAL,
    amplitude_max REAL,
    -- Growth rate of small deviations per period, of a motion that does not repeat itself.
    growth REAL,
    -- Periods that were marched.
    periods INTEGER NOT NULL
) WITHOUT ROWID;
