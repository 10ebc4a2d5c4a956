"""Reference for arma_profile.rs: profile-likelihood intervals of ARMA(1,1) with scipy and the exact
likelihood written out plainly (Brockwell & Davis 1991, equation 8.7.4 with example 5.3.4)."""

import math

import numpy as np
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.stats import chi2


def series(count):
    state, values, slow = 1, [], 0.0

    def uniform():
        nonlocal state
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        return (state >> 11) / 2**53 - 0.5

    for _ in range(count):
        slow = 0.98 * slow + 0.3 * uniform()
        values.append(slow + uniform())
    return values


def log_likelihood(record, phi, theta):
    ratio = (1.0 + theta * theta - 2.0 * phi * theta) / (1.0 - phi * phi)
    predicted, squares, logs = 0.0, 0.0, 0.0
    for value in record:
        error = value - predicted
        squares += error * error / ratio
        logs += math.log(ratio)
        predicted = phi * value - theta / ratio * error
        ratio = 1.0 + theta * theta - theta * theta / ratio
    count = len(record)
    return -0.5 * (count * (math.log(2.0 * math.pi * squares / count) + 1.0) + logs)


def main():
    record = series(500)
    at = lambda logs: log_likelihood(record, -math.expm1(logs[0]), -math.expm1(logs[1]))
    best = minimize(
        lambda logs: -at(logs), [-4.0, -1.0], method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-10}
    )
    print("log-likelihood %.9f" % -best.fun)
    for own, name in enumerate(["phi", "theta"]):

        def excess(value):
            def of(other):
                logs = [value, other] if own == 0 else [other, value]
                return -at(logs)

            # Everywhere on a grid, then to the bottom.
            grid = np.arange(-9.0, 0.65, 0.25)
            near = min(grid, key=of)
            found = minimize_scalar(of, bounds=(near - 0.25, min(near + 0.25, 0.69)), method="bounded",
                                    options={"xatol": 1e-8})
            return found.fun - best.fun - 0.5 * chi2.ppf(0.95, 1)

        centre = best.x[own]
        low = brentq(excess, centre - 3.0, centre, xtol=1e-7)
        high = brentq(excess, centre, min(centre + 3.0, 0.69), xtol=1e-7)
        print("%s: estimate %.6f, interval %.6f to %.6f" % (name, centre, low, high))


main()
