"""Coefficients of ARMA models that are sums of independent processes, by factoring the sum's spectrum (numpy).

Printed lines stand in crates/noise/tests/it/export.rs. Rate 100 Hz, x_t - ar_1 x_{t-1} - ... = a_t - ma_1 a_{t-1} - ...
"""

import numpy as np


def spectrum(numerators, denominators):
    """Sum of v_i |n_i|^2 / |d_i|^2 over the common denominator: AR coefficients, MA coefficients, innovations."""
    ar = np.array([1.0])
    for d in denominators:
        ar = np.convolve(ar, d)
    total = np.zeros(1)
    for i, (variance, n) in enumerate(numerators):
        side = np.array(n, float)
        for j, d in enumerate(denominators):
            if j != i:
                side = np.convolve(side, d)
        two_sided = variance * np.convolve(side, side[::-1])
        width = max(len(total), len(two_sided))
        centred = [np.pad(a, (width - len(a)) // 2) for a in (total, two_sided)]
        total = centred[0] + centred[1]
    total = np.trim_zeros(total)
    roots = np.roots(total)
    inside = roots[np.abs(roots) < 1]
    ma = np.real(np.poly(inside))
    sigma2 = total[len(total) // 2] / np.sum(ma**2)
    return -ar[1:], -ma[1:], np.sqrt(sigma2)


def show(name, parts):
    ar, ma, sigma = spectrum(*parts)
    print(name, f"ar = {[float(x) for x in ar]}, ma = {[float(x) for x in ma]}, sigma = {float(sigma)!r}")


def pair(radius, hertz):
    return [1.0, -2 * radius * np.cos(2 * np.pi * hertz / 100), radius**2]


walk = [1.0, -1.0]
# A random walk of 1e-4 a step, short memory (pole 0.3, drive 0.01), a resonance at 7.3 Hz (radius 0.999, drive 1e-3).
show("ARMA(4,3)", ([(1e-8, [1]), (1e-4, [1]), (1e-6, [1])], [walk, [1.0, -0.3], pair(0.999, 7.3)]))
# The same with a Gauss-Markov bias of 50 s and 0.002 in place of the walk.
phi = np.exp(-0.01 / 50)
show("ARMA(4,3)", ([(4e-6 * (1 - phi**2), [1]), (1e-4, [1]), (1e-6, [1])], [[1.0, -phi], [1.0, -0.3], pair(0.999, 7.3)]))
# White noise of 0.01 a sample, the walk, and a negative pole: q > p - 1.
show("ARMA(2,2)", ([(1e-8, [1]), (1e-4, [1]), (1e-4, [1])], [walk, [1.0], [1.0, 0.5]]))
# White noise that is the difference of the last two draws, and a walk: q > p.
show("ARMA(1,3)", ([(1e-8, [1]), (1e-4, [1.0, 0.5, 0.0, 0.25])], [walk, [1.0]]))
# White noise of 0.01 a sample and a bias that swings: two slow complex poles, 300 s and a decay of 100 s, driven through a
# zero so that it moves like a random walk over short times. Its drive is the second difference of its autocovariance at 0.
rho, turn = np.exp(-0.01 / 100), 2 * np.pi * 0.01 / 300
swing = [1.0, -2 * rho * np.cos(turn), rho**2]
zero = [1.0, -np.exp(-0.01 / 50)]
show("ARMA(2,2)", ([(1e-4, [1]), (1e-8, zero)], [[1.0], swing]))
# Autocovariance by the impulse response, then -2 c ln(lambda) by a fit of its two exponentials: slope at lag 0+.
response = np.zeros(400_000)
response[0], response[1] = 1.0, zero[1] + 2 * rho * np.cos(turn)
for k in range(2, len(response)):
    response[k] = 2 * rho * np.cos(turn) * response[k - 1] - rho**2 * response[k - 2]
lags = [1e-8 * np.dot(response[: len(response) - k], response[k:]) for k in range(3)]
# The slope at 0 of the exponentials through lags 1 and 2, and through lag 0 as q < p: a parabola is exact to 1e-8.
slope = (-3 * lags[0] + 4 * lags[1] - lags[2]) / 2
print("drive", float(np.sqrt(-2 * slope * 100)))
