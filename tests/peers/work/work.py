#!/usr/bin/env python3
"""Error against run time beside other libraries, on the project's scenes with references: whole motions, from time 0 to the last sample.

usage: work.py WORK [--scenes a,b] [--libs mujoco,drake] [--most 1.0] [--rounds 7] [--out DIR]
Environment OURS='path': our program (program/), by the tree and with compiled scenes.

Programs read lines and answer one line each:

    info                               -> free text
    load FILE                          -> ok AXES METHOD:KNOB ...     or   skip REASON
    run METHOD VALUE T_END REPS MAX_S  -> ok SECONDS_LEAST SECONDS_MEDIAN REPETITIONS EVALUATIONS STEPS, then 18 numbers a body   or   fail REASON

AXES is `body` or `child`: whether numbers are in the axes of the body or in those of its joint's child frame. Each method is run from coarse to fine until
a run takes longer than --most; where an accuracy that is asked lies between two runs, the knob is halved twice between them. The fastest runs of each
program that reach it are then repeated in rounds through all programs, and the least time of each counts.
"""

import argparse, csv, json, math, os, select, subprocess, sys
import scenes, mjcf

# Programs leave their logs here.
WORK = os.environ.get('PEERS_WORK', os.path.expanduser('~/.cache/peers'))
HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(f'{HERE}/../../..')
ASKED = [1e-6, 1e-9]
KNOBS = {
    'tol': [10 ** (-k / 2) for k in range(4, 28)],
    'accuracy': [10 ** (-k / 2) for k in range(6, 28)],
    'steps': [2**k for k in range(3, 24)],
}


class Program:
    def __init__(self, name, command, form):
        self.name, self.command, self.form, self.file = name, command, form, None
        self.start()
        self.info = self.ask('info')

    def start(self):
        env = dict(os.environ, PYTHONPATH=HERE, OMP_NUM_THREADS='1', OPENBLAS_NUM_THREADS='1')
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(self.command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True, env=env, cwd=WORK)

    def ask(self, line, most=60.0):
        """The answer; a program that has none after so many seconds, or ends, is started anew."""
        self.process.stdin.write(line + '\n')
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], most)
        answer = self.process.stdout.readline().strip() if ready else ''
        if answer:
            return answer
        self.process.kill()
        self.process.wait()
        self.start()
        if self.file:
            self.process.stdin.write(f'load {self.file}\n')
            self.process.stdin.flush()
            self.process.stdout.readline()
        return 'fail the program ended' if ready else 'fail takes longer'

    def load(self, files):
        self.file = files.get(self.form)
        answer = self.ask(f'load {self.file}').split() if self.file else ['skip', files['why']]
        self.refusal = ' '.join(answer[1:]) if answer[0] != 'ok' else None
        self.ways = [] if self.refusal else [way.split(':') for way in answer[2:]]
        self.own_axes = answer[1] == 'body'


class Point:
    def __init__(self, program, scene, method, value, repetitions, most):
        self.program, self.method, self.value = program, method, value
        # Other work on the machine may take as much time again.
        limit = 4.0 * most * max(1, repetitions) + 1.0
        answer = program.ask(f'run {method} {value!r} {scene["t_end"]!r} {repetitions} {most}', limit).split()
        self.failure = None if answer[0] == 'ok' else ' '.join(answer[1:])
        self.error = math.inf
        if not self.failure:
            self.least, self.median = float(answer[1]), float(answer[2])
            self.evaluations, self.steps = int(answer[4]), int(answer[5])
            self.error = scenes.errors(scene, [float(x) for x in answer[6:]], program.own_axes)


def sweep(program, scene, method, knob, most):
    """Points of one method from coarse to fine, and those between that accuracies asked lie at."""
    points, best = [], None
    for value in KNOBS[knob]:
        point = Point(program, scene, method, value, 3, most)
        points.append(point)
        if point.failure:
            # Coarse runs of some methods break down and crawl where finer ones go through.
            if 'longer' in point.failure and (best or len(points) > 3):
                break
            continue
        if best is None or point.error < best.error:
            best = point
        # Much more work for no less error: rounding, or what the method cannot follow.
        stalled = point is not best and point.evaluations > 8 * best.evaluations and best.error < 1e-5
        if stalled or point.least > most or best.error < 1e-11:
            break
    for error in ASKED:
        for _ in range(2):
            points.sort(key=lambda p: p.value, reverse=knob != 'steps')
            reached = [i for i, p in enumerate(points) if p.error <= error]
            if not reached or reached[0] == 0 or points[reached[0] - 1].failure:
                break
            middle = math.sqrt(points[reached[0]].value * points[reached[0] - 1].value)
            points.append(Point(program, scene, method, round(middle) if knob == 'steps' else middle, 3, most))
    return points


def starts_elsewhere(program, scene):
    """Refuses a model that is not at the first sample of the reference after the shortest of runs."""
    if not program.ways:
        return
    method, knob = program.ways[0]
    short = dict(scene, t_end=scene['t_end'] * 1e-15, expected=scene['first'])
    point = Point(program, short, method, 1 if knob == 'steps' else 1e-6, 1, 10.0)
    # Stiff springs push at 1e12 m/s²: in that time, by a thousandth.
    if not point.failure and point.error > 1e-2:
        program.refusal, program.ways = f'its model starts {point.error:.1e} from the reference', []


def fastest(points, error):
    reached = [p for p in points if not p.failure and p.error <= error]
    return min(reached, key=lambda p: p.least) if reached else None


def choose(program, points, error):
    """The points of a program that are repeated: its fastest method, and of ours the automatic choice as well."""
    chosen = {}
    own = [p for p in points if p.program is program]
    best = fastest([p for p in own if p.method != 'auto'], error)
    if best:
        chosen[program.name] = best
    auto = fastest([p for p in own if p.method == 'auto'], error)
    if auto and program.name == 'hamel':
        chosen[f'{program.name} auto'] = auto
    return chosen


def rounds(scene, chosen, count):
    """Least seconds of each, in rounds through all."""
    least = {}
    for _ in range(count):
        for label, p in chosen.items():
            again = Point(p.program, scene, p.method, p.value, max(1, min(2000, int(0.02 / p.least))), 2 + 4 * p.least)
            least[label] = min(least.get(label, p.least), again.least if not again.failure else math.inf)
    return least


def files(path, scene, folder):
    """What programs load of a scene."""
    made = dict(toml=path, why='')
    plain = f'{folder}/{scene["name"]}.json'
    json.dump(scenes.plain(scene), open(plain, 'w'))
    made['json'] = plain
    try:
        text = mjcf.text(scene)
        open(f'{folder}/{scene["name"]}.xml', 'w').write(text)
        made['xml'] = f'{folder}/{scene["name"]}.xml'
    except scenes.Beyond as reason:
        made['why'] = str(reason)
    return made


def bare_call(work, scene, folder):
    """Nanoseconds of Pinocchio's forward dynamics in a compiled loop; None where the harness has not its joints."""
    bench = f'{work}/build/bench_pin_clang'
    lines = pinocchio_model(scene)
    if lines is None or not os.path.exists(bench):
        return None
    import numpy as np

    model, states = f'{folder}/{scene["name"]}.model.txt', f'{folder}/{scene["name"]}.states.bin'
    q, v = [], []
    for link in scene['links']:
        order = link['q']
        if link['joints'][0]['kind'] == 'S':
            order = link['q'][1:] + link['q'][:1]
        if link['joints'][0]['kind'] == 'FF':
            order = link['q'][:3] + link['q'][4:] + link['q'][3:4]
        q += order
        v += link['v']
    open(model, 'w').write('\n'.join([f'model {scene["name"]}', 'gravity ' + ' '.join(map(repr, map(float, scene['gravity']))), f'sizes {len(lines)} {len(q)} {len(v)}', *lines]) + '\n')
    np.array((q + v + [0.0] * len(v)) * 16, dtype='<f8').tofile(states)
    asked = f'load {scene["name"]} {model} {states}\nbench aba 50\nbench aba 50\nbench aba 50\nquit\n'
    answer = subprocess.run([bench], input=asked, capture_output=True, text=True).stdout.split('\n')
    try:
        return min(float(line) for line in answer[1:4])
    except ValueError:
        return None


def pinocchio_model(scene):
    """Lines of the format of ../gen_models.py; a link of several joints is a chain of massless ones."""
    lines, index = [], []
    for link in scene['links']:
        parent = 0 if link['parent'] < 0 else index[link['parent']]
        R, p = link['R'], link['p']
        for k, joint in enumerate(link['joints']):
            if joint['kind'] == 'H':
                return None
            last = k + 1 == len(link['joints'])
            I = link['inertia']
            mass = [link['mass'], *link['com'], I[0][0], I[0][1], I[0][2], I[1][1], I[1][2], I[2][2]] if last else [0.0] * 10
            numbers = [*joint['axis'], *[x for row in R for x in row], *p, *mass]
            lines.append(f'joint {len(lines) + 1} {parent} {joint["kind"]} ' + ' '.join(repr(float(x)) for x in numbers))
            parent, R, p = len(lines), [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0]
        index.append(len(lines))
    return lines


def processor():
    """Name of the processor, as Linux tells it."""
    lines = open('/proc/cpuinfo').read().split('\n')
    names = [line.split(':', 1)[1].strip() for line in lines if line.startswith('model name')]
    return names[0] if names else 'unknown'


def references():
    folder = f'{ROOT}/scenes/report'
    for name in sorted(os.listdir(folder)):
        if name.endswith('.json'):
            scene = name[:-5] + '.toml'
            path = f'{folder}/{scene}'
            yield name[:-5], path if os.path.exists(path) else f'{ROOT}/scenes/{scene}', f'{folder}/{name}'


def programs(work, wanted):
    python = {'pinocchio': f'{work}/venv/bin/python', 'drake': f'{work}/venv_drake/bin/python'}
    ours = os.environ.get('OURS', f'{work}/target/release/peer-work')
    known = [('hamel', [ours], 'toml'), ('hamel compiled', [ours, '--compiled'], 'toml')]
    known.append(('mujoco', [f'{work}/build/work_mujoco'], 'xml'))
    known += [(name, [command, f'{HERE}/work_{name}.py'], 'json') for name, command in python.items()]
    for name, command, form in known:
        if os.path.exists(command[0]) and (name.startswith('hamel') or not wanted or name in wanted):
            yield Program(name, command, form)


def milliseconds(seconds):
    return f'{1e3 * seconds:.3g}'


def row(scene, error, chosen, least, all_programs, bare):
    """A line of the table."""
    own = [p for p in all_programs if p.name.startswith('hamel')]
    cells = [scene['name'], f'{error:.0e}']
    for label in [p.name for p in own] + ['hamel auto']:
        p = chosen.get(label)
        cells.append(f'{milliseconds(least[label])} {p.method}' if p else '—')
    for program in all_programs[len(own) :]:
        p = chosen.get(program.name)
        if program.refusal:
            cells.append('not expressible')
        elif not p:
            cells.append('not reached')
        else:
            ratios = [least[program.name] / least.get(ours.name, math.inf) for ours in own]
            ratios = ', '.join(f'{ratio:.1f}' if ratio else '—' for ratio in ratios)
            cell = f'{milliseconds(least[program.name])} {p.method} (**{ratios}**)'
            if program.name == 'pinocchio':
                ratio = p.evaluations / chosen['hamel'].evaluations if 'hamel' in chosen else math.nan
                inside = f', inside calls {milliseconds(1e-9 * bare * p.evaluations)}' if bare else ''
                cell += f'; evaluations {ratio:.2f}{inside}'
            cells.append(cell)
    return '| ' + ' | '.join(cells) + ' |'


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('work')
    parser.add_argument('--scenes')
    parser.add_argument('--libs')
    parser.add_argument('--most', type=float, default=1.0)
    parser.add_argument('--rounds', type=int, default=7)
    parser.add_argument('--out')
    args = parser.parse_args()
    out = args.out or f'{args.work}/results'
    folder = f'{args.work}/scenes'
    os.makedirs(folder, exist_ok=True)
    os.makedirs(out, exist_ok=True)
    all_programs = list(programs(args.work, args.libs and args.libs.split(',')))
    print('\n'.join(f'- {p.name}: {p.info}' for p in all_programs))
    own = [p.name for p in all_programs if p.name.startswith('hamel')]
    names = ['scene', 'error', *[f'{name}, ms' for name in own], 'hamel auto, ms']
    names += [f'{p.name}, ms (/ {", / ".join(own)})' for p in all_programs[len(own) :]]
    print('\n| ' + ' | '.join(names) + ' |\n|' + '---|' * len(names))
    table = csv.writer(open(f'{out}/work.csv', 'w'))
    table.writerow('scene library method value error seconds_least seconds_median evaluations steps failure version machine'.split())
    machine, reasons = processor(), []
    for name, path, reference in references():
        if args.scenes and name not in args.scenes.split(','):
            continue
        try:
            scene = scenes.load(path, reference)
        except scenes.Beyond as reason:
            reasons.append(f'- {name}: {reason}')
            continue
        made = files(path, scene, folder)
        points = []
        for program in all_programs:
            program.load(made)
            starts_elsewhere(program, scene)
            if program.refusal:
                reasons.append(f'- {name}, {program.name}: {program.refusal}')
            for method, knob in program.ways:
                print(f'{name} {program.name} {method}', file=sys.stderr)
                points += sweep(program, scene, method, knob, args.most)
        for p in points:
            done = [p.least, p.median, p.evaluations, p.steps, ''] if not p.failure else ['', '', '', '', p.failure]
            table.writerow([name, p.program.name, p.method, p.value, p.error, *done, p.program.info, machine])
        bare = bare_call(args.work, scenes.plain(scene), folder)
        for error in ASKED:
            chosen = {}
            for program in all_programs:
                chosen.update(choose(program, points, error))
            least = rounds(scene, chosen, args.rounds)
            print(row(scene, error, chosen, least, all_programs, bare), flush=True)
    if reasons:
        print('\nNot measured:\n\n' + '\n'.join(reasons))


if __name__ == '__main__':
    main()
