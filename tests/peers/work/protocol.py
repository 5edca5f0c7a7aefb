"""The line protocol of programs that run whole motions; work.py tells it."""

import sys, time


def serve(info, load, run):
    """`load(file)` gives an object and its ways, `run(object, method, value, t_end)` one run: (state after it, evaluations, steps)."""
    loaded = None
    for line in sys.stdin:
        words = line.split()
        if not words or words[0] == 'quit':
            return
        try:
            if words[0] == 'info':
                answer = info
            elif words[0] == 'load':
                loaded, ways = load(words[1])
                answer = 'ok child ' + ' '.join(ways)
            else:
                answer = measured(loaded, run, words)
        except Exception as error:
            told = str(error).splitlines() or [type(error).__name__]
            answer = ('skip ' if words[0] == 'load' else 'fail ') + told[0]
        print(answer, flush=True)


def measured(loaded, run, words):
    _, method, value, t_end, repetitions, most = words
    seconds, start = [], time.thread_time()
    while len(seconds) < int(repetitions) and (not seconds or time.thread_time() - start < float(most)):
        begin = time.thread_time()
        finish, evaluations, steps = run(loaded, method, float(value), float(t_end), float(most))
        seconds.append(time.thread_time() - begin)
    seconds.sort()
    figures = [seconds[0], seconds[len(seconds) // 2], len(seconds), evaluations, steps] + list(finish())
    return 'ok ' + ' '.join(repr(x if isinstance(x, int) else float(x)) for x in figures)
