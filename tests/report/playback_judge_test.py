"""What scripts/bench/playback_memory.py calls a stall of the pager.

usage: playback_judge_test.py SOURCE_DIR
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(sys.argv[1]) / "scripts" / "bench"))
import playback_memory as bench


def frames(loads, ms=20.0):
    return [{"ms": ms + load, "load_ms": load} for load in loads]


ALONE = {"longest": 1000.0}  # of a film without a limit, on a machine that is busy


def film(loads, name="forward", arrival="wait", ms=20.0, free=ALONE):
    return bench.stalls(name, arrival, bench.times_of(frames(loads, ms)), free)


quiet = [0.5] * 40
assert not film(quiet)
assert not film([500.0, *quiet]), "the first picture has nothing before it"
assert film([0.5, 500.0, *quiet]), "the second is the pager's"
assert film([*quiet, 61.5]) and not film([*quiet, 60.5]), "two medians of 20.5 ms and 20 ms are the limit"
assert film([*quiet, 61.5], "backward", "draw") and not film([*quiet, 61.5], "jumps", "wait")
assert not film([*quiet, 99.0], ms=40.0), "slow pictures may wait longer"

slow = frames(quiet)
slow[20]["ms"] = 900.0  # of drawing
assert not bench.stalls("forward", "wait", bench.times_of(slow), ALONE), "as without a limit"
assert bench.stalls("forward", "wait", bench.times_of(slow), {"longest": 899.0}), "longer than any without a limit"
assert bench.stalls("jumps", "wait", bench.times_of(slow), {"longest": 30.0}), "jumps too"
assert not bench.stalls("forward", "draw", bench.times_of(slow), {"longest": 30.0}), "a film at its pace shares the cores with its pager"
slow[20]["ms"] = 61.0
assert not bench.stalls("forward", "wait", bench.times_of(slow), {"longest": 30.0}), "three medians of 20.5 ms are the limit"

told = bench.times_of(frames([300.0, 200.0, 1.0, 2.0, 3.0]))
assert told["first"] == [320.0, 220.0] and told["median"] == 22.0 and told["longest"] == 23.0 and told["load"] == 200.0, told

# Only what others used counts as theirs.
(result, others) = bench.watched(lambda: sum(range(1000)))
assert result == 499500 and 0 <= others, others
