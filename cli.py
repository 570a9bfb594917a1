"""The command line: parses, calls, prints; no mathematics. Everything heavy is imported by the verb that needs it."""

from __future__ import annotations

from . import cli_options as cli
from .cli_app import run_application, verb
from .console import Outcome, Printer
from .models.errors import InputError
from .workflows.certify import as_json as certificate_json
from .workflows.certify import certify_gains
from .workflows.check import check_fleet
from .workflows.compare import compare_designs
from .workflows.design import DesignOptions, design_fleet
from .workflows.inputs import (
    DisturbanceOptions,
    Pool,
    StartOptions,
    Starts,
    conditions_of,
    digests_of,
    read_fleet,
    read_gains,
    tolerance_of,
)
from .workflows.obstacles import say_obstacles, say_slips_of_run
from .workflows.physics import PhysicsRun, refuse_with_mujoco, validate_in_physics
from .workflows.prove import check_formally, prove_claims, theorem_holds
from .workflows.run import Pipeline
from .workflows.simulate import Simulation, simulate_schemes
from .workflows.validate import (
    Validation,
    default_horizon,
    replay_start,
    spec_of,
    validate_starts,
    validation_exit_code,
)


@verb
def init(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    template: cli.TemplateOption = cli.Template.paper,
    vehicles: cli.Vehicles = None,
) -> Outcome:
    """Write a fleet file to start from."""
    from .models.files.templates import template_text
    from .models.files.text import write_text

    if fleet_path.exists():
        raise InputError(f"{fleet_path}: is already there; choose another name or remove it")
    write_text(fleet_path, template_text(template.value, vehicles))
    printer.say(f"wrote {fleet_path}; next: gaincert check {fleet_path}")
    return Outcome({"fleet": str(fleet_path), "template": template.value})


@verb
def check(printer: Printer, *, fleet_path: cli.FleetPath) -> Outcome:
    """Show the content of a fleet file, or all its mistakes."""
    return Outcome(check_fleet(printer, fleet_path))


@verb
def prove(
    printer: Printer, *, folder: cli.ProofFolder = None, fleet: cli.ProofFleet = None, formal: cli.ProofFormal = False
) -> Outcome:
    """Check the paper and the corrected theorem."""
    from .reports.proof.documents import claims_to_json

    compiled = check_formally(printer) if formal else True
    claims = prove_claims(printer, None if fleet is None else read_fleet(fleet), folder)
    return Outcome.of(claims_to_json(claims), true=compiled and theorem_holds(claims))


@verb
def design(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    folder: cli.Folder,
    mode: cli.ModeOption = cli.Mode.fast,
    conditions: cli.ConditionsOption = cli.Conditions.paper,
    excitation: cli.ExcitationOption = None,
    saturation: cli.SaturationOption = None,
    weights: cli.WeightsOption = cli.Source.given,
    seed: cli.Seed = 0,
    time_limit: cli.TimeLimit = 600.0,
    digits: cli.Digits = 4,
    tolerance: cli.ToleranceOption = (0.1, 0.1),
    torque_factor: cli.TorqueFactor = 1.0,
    box: cli.Box = None,
    workers: cli.Workers = None,
    scheduler: cli.Scheduler = None,
    compare: cli.Compare = False,
    against: cli.Against = None,
) -> Outcome:
    """Choose gains that settle the fleet fast and meet the conditions."""
    fleet = read_fleet(fleet_path)
    if against is not None:
        read_gains(against, fleet)  # report its mistakes before the work begins
    demands = time_limit, tolerance_of(tolerance), torque_factor, box
    options = DesignOptions(mode, conditions, excitation, saturation, weights, seed, digits, *demands)
    designed = design_fleet(printer, fleet, options, folder, Pool(workers, scheduler))
    document = {**designed.document, "certificate": certificate_json(designed.certificate, conditions, folder)}
    if compare or against is not None:
        document["compared"] = compare_designs(printer, designed.design, options, folder, compare, against)
    say_obstacles(printer, designed.obstacles)
    return Outcome.of(document, true=designed.certificate.valid)


@verb
def certify(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    gains: cli.GainsPath,
    folder: cli.Folder,
    conditions: cli.CertifiedConditions = None,
) -> Outcome:
    """Certify given gains."""
    fleet = read_fleet(fleet_path)
    chosen = read_gains(gains, fleet)
    name = conditions_of(conditions, chosen)
    certificate = certify_gains(printer, fleet, chosen, name, folder)
    return Outcome.of(certificate_json(certificate, name, folder), true=certificate.valid)


@verb
def verify(printer: Printer, *, certificate: cli.CertificatePath, fleet: cli.CertifiedFleet = None) -> Outcome:
    """Check a certificate again with the trusted kernel alone."""
    from .verify.certificates.certify import verify as verify_file

    verdict = verify_file(certificate, None if fleet is None else read_fleet(fleet))
    printer.say(*str(verdict).split("\n"))
    document = {"valid": verdict.valid, "rule": verdict.rule, "reason": verdict.reason, "theorem": verdict.theorem}
    return Outcome.of(document, true=verdict.valid)


@verb
def simulate(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    gains: cli.GainsPath,
    folder: cli.Folder,
    scheme: cli.SchemeOption = cli.Scheme.bounded,
    horizon: cli.OpenHorizon = None,
    sample_time: cli.SampleTime = None,
    delay: cli.Delay = None,
    noise: cli.Noise = None,
    noise_speed: cli.NoiseSpeed = None,
    mismatch: cli.Mismatch = None,
    friction: cli.Friction = None,
    lost_link: cli.LostLink = None,
    com_offset: cli.ComOffset = False,
    seed: cli.NoiseSeed = 0,
    tolerance: cli.ToleranceOption = (0.1, 0.1),
    engine: cli.EngineOption = cli.Engine.auto,
) -> Outcome:
    """Simulate the fleet from its own start and draw figures."""
    fleet = read_fleet(fleet_path)
    chosen, settled = read_gains(gains, fleet), tolerance_of(tolerance)
    disturbed = DisturbanceOptions(sample_time, delay, noise, noise_speed, mismatch, friction, lost_link, com_offset)
    simulation = Simulation((scheme,), horizon, settled, engine, disturbed.of(fleet, seed))
    say_slips_of_run(printer, fleet, simulation.disturbance)
    simulated = simulate_schemes(printer, fleet, chosen, simulation, folder)
    say_obstacles(printer, simulated.obstacles)
    return Outcome.of(simulated.document, true=not simulated.false_claims and not simulated.obstacles)


@verb
def validate(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    gains: cli.GainsPath,
    folder: cli.Folder,
    starts: cli.Starts = 100,
    starts_file: cli.StartsFile = None,
    box: cli.Box = None,
    seed: cli.Seed = 0,
    horizon: cli.Horizon = None,
    tolerance: cli.ToleranceOption = (0.1, 0.1),
    workers: cli.Workers = None,
    scheduler: cli.Scheduler = None,
    integrator: cli.MethodOption = cli.Method.auto,
    sample_time: cli.SampleTime = None,
    delay: cli.Delay = None,
    noise: cli.Noise = None,
    noise_speed: cli.NoiseSpeed = None,
    mismatch: cli.Mismatch = None,
    friction: cli.Friction = None,
    lost_link: cli.LostLink = None,
    com_offset: cli.ComOffset = False,
    margins: cli.Margins = False,
    replay: cli.Replay = None,
    plant: cli.PlantOption = cli.Plant.model,
) -> Outcome:
    """Simulate from many starts; continues an interrupted validation."""
    fleet = read_fleet(fleet_path)
    chosen, settled = read_gains(gains, fleet), tolerance_of(tolerance)
    drawn = Starts.of(fleet, StartOptions(max(starts, 0 if replay is None else replay + 1), starts_file, seed, box))
    end = default_horizon(fleet, chosen, settled) if horizon is None else horizon
    disturbed = DisturbanceOptions(sample_time, delay, noise, noise_speed, mismatch, friction, lost_link, com_offset)
    real = disturbed.of(fleet, seed)
    say_slips_of_run(printer, fleet, real)
    if plant is cli.Plant.mujoco:
        refuse_with_mujoco(
            ("--replay", replay is not None),
            ("--margins", margins),
            ("--scheduler", scheduler is not None),
            ("--integrator", integrator is not cli.Method.auto),
        )
        physics = PhysicsRun(drawn.states, end, settled, real, workers)
        document = validate_in_physics(printer, fleet, chosen, physics, folder)
        return Outcome(document, validation_exit_code(document))
    spec, digests = spec_of(fleet, chosen, drawn, end, settled, integrator), digests_of(fleet, chosen)
    if replay is not None:
        document = replay_start(printer, Validation(spec, digests, drawn.states, seed), replay, folder)
        return Outcome.of(document, true=document["same"] is not False)
    random_seed = None if starts_file else seed
    validation = Validation(spec, digests, drawn.states, random_seed, real, margins, pool=Pool(workers, scheduler))
    document = validate_starts(printer, fleet, validation, folder)
    return Outcome(document, validation_exit_code(document))


@verb
def report(
    printer: Printer, *, folder: cli.ResultFolder, animate: cli.Animate = None, fleet: cli.FolderFleet = None
) -> Outcome:
    """Write one HTML report of all results in a folder."""
    from .reports.html.page import write_report

    document = {"report": str(write_report(folder, fleet))}
    if animate is not None:
        from .reports.figures.movie import write_movie

        with printer.progress() as progress:
            document["animation"] = str(write_movie(folder, animate.value, fleet, progress))
    printer.say(*(f"{kind}: {path}" for kind, path in document.items()))
    return Outcome(document)


@verb
def export(
    printer: Printer,
    *,
    folder: cli.ResultFolder,
    kind: cli.FormatOption,
    interface: cli.InterfaceOption = cli.Interface.effort,
    fleet: cli.FolderFleet = None,
) -> Outcome:
    """Write the gains for robots, spreadsheets and papers, or a run for log viewers."""
    from .reports.export.formats import export as export_files

    paths = [str(path) for path in export_files(folder, kind.value, fleet, interface.value)]
    printer.say(*(f"wrote {path}" for path in paths))
    return Outcome({"format": kind.value, "files": paths})


@verb
def run(
    printer: Printer,
    *,
    fleet_path: cli.FleetPath,
    folder: cli.Folder,
    gains: cli.GivenGains = None,
    mode: cli.ModeOption = cli.Mode.fast,
    conditions: cli.CertifiedConditions = None,
    excitation: cli.ExcitationOption = None,
    saturation: cli.SaturationOption = None,
    weights: cli.WeightsOption = cli.Source.given,
    seed: cli.Seed = 0,
    time_limit: cli.TimeLimit = 600.0,
    digits: cli.Digits = 4,
    horizon: cli.OpenHorizon = None,
    tolerance: cli.ToleranceOption = (0.1, 0.1),
    torque_factor: cli.TorqueFactor = 1.0,
    box: cli.Box = None,
) -> Outcome:
    """Design, certify, prove, simulate, report: all in one."""
    fleet, settled = read_fleet(fleet_path), tolerance_of(tolerance)
    wanted = conditions or cli.Conditions.paper
    options = DesignOptions(
        mode, wanted, excitation, saturation, weights, seed, digits, time_limit, settled, torque_factor, box
    )
    disturbance = DisturbanceOptions().of(fleet, seed)
    simulation = Simulation(tuple(cli.Scheme), horizon, settled, disturbance=disturbance)
    pipeline = Pipeline(printer, fleet, simulation, folder)
    if gains is None:
        return pipeline.run(options)
    chosen = read_gains(gains, fleet)
    return pipeline.run_given(chosen, conditions_of(conditions, chosen))


def main() -> None:
    """The command line."""
    run_application()
