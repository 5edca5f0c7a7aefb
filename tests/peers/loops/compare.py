#!/usr/bin/env python3
"""Interleaved measurement of forward dynamics of mechanisms with loops: every repetition visits every program and algorithm of a mechanism once, and ratios
are taken within a repetition. Errors are those against exact accelerations (exact.py).

usage: compare.py FOLDER LABEL=COMMAND ... [--reps 21] [--ms 8] [--models a,b]
A program speaks the protocol at the head of program/src/main.rs. Ratios are to the label `hamel compiled`.
"""

import argparse, glob, json, os, re, select, statistics, subprocess, sys

parser = argparse.ArgumentParser()
parser.add_argument('folder')
parser.add_argument('programs', nargs='+')
parser.add_argument('--reps', type=int, default=21)
parser.add_argument('--ms', type=float, default=8)
parser.add_argument('--models')
given = parser.parse_args()
OURS = 'hamel'
BASE = 'hamel compiled'


class Program:
    def __init__(self, label, command):
        self.label = label
        self.process = subprocess.Popen(command, shell=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def ask(self, line, timeout=120):
        try:
            self.process.stdin.write(line + '\n')
            self.process.stdin.flush()
        except OSError:
            return 'skip it has ended'
        if not select.select([self.process.stdout], [], [], timeout)[0]:
            self.process.kill()
            return 'skip no answer'
        return self.process.stdout.readline().strip() or 'skip it has ended'


def error(program, algorithm, answers):
    """Largest error of the states that have exact answers, relative to max(1, largest component)."""
    worst = 0.0
    for k, expected in enumerate(answers['ours' if program.label.startswith(OURS) else 'tree']):
        try:
            found = [float(x) for x in program.ask(f'check {algorithm} {k}').split()]
        except ValueError:
            return None
        if len(found) != len(expected):
            return None
        size = max([1.0] + [abs(x) for x in expected])
        off = [abs(x - y) / size for x, y in zip(found, expected)]
        worst = max(off + [worst]) if all(x == x for x in off) else float('inf')
    return worst


def measure(name):
    """Rows of (label and algorithm, median ns, median ratio to the base, error), and reasons for what is left out."""
    programs = [Program(*program.split('=', 1)) for program in given.programs]
    answers = json.load(open(os.path.join(given.folder, f'{name}.json')))
    ways, left_out = [], []
    for program in programs:
        answer = program.ask(f'load {given.folder} {name}')
        if answer.startswith('ok'):
            ways += [(program, algorithm) for algorithm in answer.split()[1:]]
        else:
            left_out.append(f'{name}, {program.label}: {answer.removeprefix("skip ")[:160]}')
    errors = [error(program, algorithm, answers) for program, algorithm in ways]
    times = [[] for _ in ways]
    for repetition in range(given.reps + 1):  # the first warms up
        for place, (program, algorithm) in enumerate(ways):
            answer = program.ask(f'bench {algorithm} {given.ms if repetition else 1}')
            if repetition:
                times[place].append(float(answer))
    base = next((times[k] for k, (program, _) in enumerate(ways) if program.label == BASE), None)
    rows = []
    for (program, algorithm), own, off in zip(ways, times, errors):
        ratio = statistics.median(x / y for x, y in zip(own, base)) if base else None
        label = program.label if algorithm == 'fd' else f'{program.label}, {algorithm}'
        rows.append((label, statistics.median(own), ratio, off))
    for program in programs:
        program.process.kill()
    return rows, left_out


names = [os.path.basename(path)[:-5] for path in glob.glob(os.path.join(given.folder, '*.json'))]
names.sort(key=lambda name: [int(part) if part.isdigit() else part for part in re.split(r'(\d+)', name)])
if given.models:
    names = [name for name in given.models.split(',') if name in names]
figures, notes, labels = {}, [], []
places = [program.split('=', 1)[0] for program in given.programs]
for name in names:
    rows, left_out = measure(name)
    figures[name] = {label: rest for label, *rest in rows}
    labels += [label for label, *_ in rows if label not in labels]
    notes += left_out
    print(f'# {name}', file=sys.stderr, flush=True)

labels.sort(key=lambda label: places.index(label.split(',')[0]))
print(f'Nanoseconds a call, median of {given.reps} interleaved repetitions of {given.ms:g} ms; in brackets times that of `{BASE}`, then the largest relative error.\n')
print('| mechanism | ' + ' | '.join(labels) + ' |\n|---|' + '---|' * len(labels))
for name in names:
    cells = []
    for label in labels:
        if label not in figures[name]:
            cells.append('–')
            continue
        time, ratio, off = figures[name][label]
        text = f'{time:.0f}'
        if ratio and label != BASE:
            text += f' ({ratio:.1f})'
        cells.append(text + (f', {off:.0e}' if off is not None else ''))
    print(f'| {name} | ' + ' | '.join(cells) + ' |')
for program in given.programs:
    label, command = program.split('=', 1)
    started = Program(label, command)
    print(f'\n- {label}: {started.ask("info")}')
    started.process.kill()
for note in notes:
    print(f'- not measured: {note}')
