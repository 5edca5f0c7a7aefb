#!/usr/bin/env python3
"""Interleaved measurement of all libraries: every repetition visits every (library, algorithm) of a robot once,
so slow drifts of the machine hit all alike. Reports the median over repetitions, and the ratio as the median of
the per-repetition ratios to Pinocchio. Correctness: every library's forward dynamics is compared with Pinocchio's.

usage: compare.py WORK [--reps 9] [--ms 20] [--robots a,b] [--algos aba,rnea] [--libs pinocchio,casadi_clang] [--out DIR]
Extra libraries: environment OURS='command' and EXTRA='label=command;label=command': each a program that speaks
the line protocol described at the top of src/common.hpp.
"""

import argparse, json, os, select, statistics as st, subprocess, sys, time

HERE = os.path.dirname(os.path.abspath(__file__))
ap = argparse.ArgumentParser()
ap.add_argument('work')
ap.add_argument('--reps', type=int, default=9)
ap.add_argument('--ms', type=float, default=20)
ap.add_argument('--robots')
ap.add_argument('--algos')
ap.add_argument('--libs')
ap.add_argument('--out')
a = ap.parse_args()
W = a.work
PY = f'{W}/venv/bin/python'
LIBS = [('pinocchio', f'{W}/build/bench_pin_clang', {})]
for v in ('clang_fast', 'gcc_fast'):
    LIBS.append((f'casadi_{v}', f'{W}/build/bench_cg', dict(CG_VARIANT=v, CG_DIR=f'{W}/cg')))
for v in ('clang_O3', 'gcc_O3'):
    LIBS.append(
        (f'cppadcg_{v}', f'{W}/build/bench_cg', dict(CG_VARIANT=f'cppadcg_{v}', CG_DIR=f'{W}/cg'))
    )
LIBS += [('mujoco', f'{W}/build/bench_mujoco', dict(PEERS_MODELS=f'{W}/models'))]
LIBS = [l for l in LIBS if os.path.exists(l[1].split()[0])]
for kv in filter(None, os.environ.get('EXTRA', '').split(';')):
    k, c = kv.split('=', 1)
    LIBS.append((k, c, {}))
if os.environ.get('OURS'):
    LIBS.append(('hamel', os.environ['OURS'], {}))
if os.environ.get('OURS_COMPILED'):
    LIBS.append(('hamel compiled', os.environ['OURS_COMPILED'], {}))
if a.libs:
    LIBS = [l for l in LIBS if l[0] in a.libs.split(',') or l[0].startswith('hamel')]
index = json.load(open(f'{W}/models/index.json'))
robots = [r['name'] for r in index]
if a.robots:
    robots = [r for r in robots if r in a.robots.split(',')]
nvs = {r['name']: r['nv'] for r in index}
LANES = [f'{al}_{lanes}' for al in ('aba', 'rnea') for lanes in ('x4', 'x8', 'x8_rows')]
LANES += [f'{al}_x8' for al in ('aba_deriv', 'rnea_deriv', 'crba', 'minverse')]
LANES += [f'{al}_x8_{cc}' for al in ('aba', 'rnea') for cc in ('gcc', 'clang')]
# algorithms whose results are compared, with what they are compared as
CHECKED = dict.fromkeys(('aba', 'aba_world', 'forward', 'fd_crba_chol'), 'aba') | {'rnea': 'rnea'}
CHECKED |= {al: al.split('_')[0] for al in LANES}
ALGOS = [
    'fk',
    'fk_v',
    'rnea',
    'nle',
    'crba',
    'crba_world',
    'aba',
    'aba_world',
    'forward',
    'fd_crba_chol',
    'fd_crba_llt',
    'minverse',
    'rnea_deriv',
    'aba_deriv',
    'step',
    *LANES,
]
if a.algos:
    ALGOS = [x for x in ALGOS if x in a.algos.split(',')]


class Proc:
    def __init__(s, name, cmd, env):
        s.name = name
        s.dead = None
        s.p = subprocess.Popen(
            cmd,
            shell=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            bufsize=1,
            env={**os.environ, **env},
        )

    def ask(s, line, timeout=120):
        if s.dead:
            return 'skip ' + s.dead
        try:
            s.p.stdin.write(line + '\n')
            s.p.stdin.flush()
            r, _, _ = select.select([s.p.stdout], [], [], timeout)
            if not r:
                s.dead = 'timed out'
                s.p.kill()
                return 'skip timed out'
            x = s.p.stdout.readline()
            if not x:
                s.dead = 'process ended'
                return 'skip process ended'
            return x.strip()
        except BrokenPipeError:
            s.dead = 'process ended'
            return 'skip process ended'

    def close(s):
        try:
            s.p.stdin.write('quit\n')
            s.p.stdin.flush()
            s.p.wait(5)
        except Exception:
            s.p.kill()


def vec(t):
    try:
        return [float(x) for x in t.split()]
    except ValueError:
        return None


res, notes, checks, infos = {}, [], {}, {}
for name, cmd, env in LIBS:
    p = Proc(name, cmd, env)
    infos[name] = p.ask('info')
    p.close()
for rob in robots:
    t0 = time.time()
    procs, have = [], {}
    for name, cmd, env in LIBS:
        if nvs[rob] > 1000 and name == 'pinocchio_gcc':
            continue
        p = Proc(name, cmd, env)
        r = p.ask(f'load {rob} {W}/models/{rob}.txt {W}/models/{rob}.bin')
        if not r.startswith('ok'):
            notes.append(f'{rob} / {name}: {r}')
            p.close()
            continue
        have[name] = [x for x in r.split()[1:] if x in ALGOS]
        if nvs[rob] > 1000:
            have[name] = [
                x for x in have[name] if x not in ('aba_deriv', 'minverse', 'fd_crba_chol')
            ]
        procs.append(p)
    byname = {p.name: p for p in procs}
    # correctness: forward dynamics against the 200-bit reference (else Pinocchio ABA LOCAL), rnea against Pinocchio
    exact = None
    rf = f'{HERE}/../data/robots/{rob}.json'
    if os.path.exists(rf):
        exact = json.load(open(rf))['states']
        if 'aba_qdd_exact' not in exact[0]:
            exact = None
    if 'pinocchio' in byname:
        for p in procs:
            for al, ref in CHECKED.items():
                if al not in have[p.name] or (
                    p.name == 'pinocchio' and (al == 'rnea' or (al == 'aba' and not exact))
                ):
                    continue
                e = 0.0
                for k in range(min(10, len(exact)) if exact else 10):
                    x = vec(p.ask(f'check {al} {k}'))
                    y = (
                        exact[k]['aba_qdd_exact']
                        if ref == 'aba' and exact and k < len(exact)
                        else vec(byname['pinocchio'].ask(f'check {ref} {k}'))
                    )
                    if x is None or y is None or len(x) != len(y):
                        e = None
                        break
                    d = max(abs(i - j) for i, j in zip(x, y)) / max(1.0, max(abs(j) for j in y))
                    e = max(e, d if d == d else float('inf'))
                if e is not None:
                    checks[(rob, p.name, al)] = e
    reps = a.reps if nvs[rob] < 400 else max(5, a.reps // 2)
    for rep in range(reps + 1):  # the first round warms up and is dropped
        for al in ALGOS:
            for p in procs:
                if al not in have[p.name]:
                    continue
                x = p.ask(f'bench {al} {a.ms if rep else 2}')
                try:
                    y = float(x)
                except ValueError:
                    notes.append(f'{rob} / {p.name} / {al}: {x}')
                    have[p.name].remove(al)
                    continue
                if rep:
                    res.setdefault((rob, al), {}).setdefault(p.name, []).append(y)
    for p in procs:
        p.close()
    print(f'# {rob}: {time.time()-t0:.0f} s', file=sys.stderr, flush=True)

names = [l[0] for l in LIBS]


def fmt(x):
    return f'{x:.0f}' if x >= 100 else f'{x:.1f}'


out = []
out.append(
    '## ns per call, median of %d interleaved repetitions of %g ms (in brackets: library / Pinocchio clang, median of per-repetition ratios; < 1 is faster; of functions of many states how many times as fast as that of one state in Pinocchio)\n'
    % (a.reps, a.ms)
)
out.append('| robot (nv) | algorithm | ' + ' | '.join(names) + ' |')
out.append('|---|---|' + '---|' * len(names))
for rob in robots:
    for al in ALGOS:
        d = res.get((rob, al))
        if not d:
            continue
        base = d.get('pinocchio')
        if al in ('forward', 'step'):
            base = res.get((rob, 'aba'), {}).get('pinocchio')
        lanes = al in LANES
        if lanes:
            base = res.get((rob, CHECKED[al]), {}).get('pinocchio')
        row = []
        for n in names:
            x = d.get(n)
            if not x:
                row.append('-')
                continue
            c = fmt(st.median(x))
            if base and not (n == 'pinocchio' and al not in ('forward', 'step')):
                ratio = st.median(i / j for i, j in zip(x, base))
                c += f' ({1 / ratio:.1f}x)' if lanes else f' ({ratio:.2f})'
            row.append(c)
        out.append(f'| {rob} ({nvs[rob]}) | {al} | ' + ' | '.join(row) + ' |')
out.append(
    '\n## Largest relative error over 10 states (forward dynamics against 200-bit arithmetic, RNEA against Pinocchio; relative to max(1, largest component))\n'
)
out.append('| robot | ' + ' | '.join(f'{n}' for n in names) + ' |')
out.append('|---|' + '---|' * len(names))
for rob in robots:
    row = []
    for n in names:
        c = ', '.join(
            f'{al} {checks[(rob, n, al)]:.1e}'
            for al in CHECKED
            if (rob, n, al) in checks
        )
        row.append(c or '-')
    out.append(f'| {rob} | ' + ' | '.join(row) + ' |')
out.append('\n## Libraries\n')
out += [f'- {n}: {infos[n]}' for n in names]
if notes:
    out.append('\n## Not measured\n')
    out += [f'- {x}' for x in notes]
txt = '\n'.join(out)
print(txt)
if a.out:
    os.makedirs(a.out, exist_ok=True)
    open(f'{a.out}/table.md', 'w').write(txt + '\n')
    json.dump(
        dict(
            time=time.ctime(),
            infos=infos,
            notes=notes,
            ns={f'{r}/{al}': d for (r, al), d in res.items()},
            checks={'/'.join(k): v for k, v in checks.items()},
        ),
        open(f'{a.out}/raw.json', 'w'),
    )
