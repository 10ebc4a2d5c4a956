"""The records, and whether two answers are the same: each check prints both, raises AssertionError where
they are not, and returns what to say of the difference."""

import math
import sys

from tasks import MODELS, PANDIT_WU, RATE_HZ, SIGMA

# Samples before the first, twenty times the slowest time constant: the record starts stationary.
BEFORE = 400_000


def simulate(order, samples, seed):
    """ARMA x_t = Σ φ x_{t-i} + a_t - Σ θ a_{t-j}."""
    import numpy as np
    from scipy.signal import lfilter

    phi, theta = (np.array(part) for part in MODELS[order])
    noise = np.random.Generator(np.random.PCG64(seed)).standard_normal(BEFORE + samples)
    return SIGMA * lfilter(np.r_[1.0, -theta], np.r_[1.0, -phi], noise)[BEFORE:]


def log_likelihood(record, phi, theta):
    """Exact Gaussian log-likelihood, sigma at its best: the Kalman filter of the state-space form (Brockwell
    & Davis 1991, section 12.1) with its matrices written out, until the variance of the prediction error is
    that of the noise but for 1e-12; from there on the recursion of the definition. Slow and plain on
    purpose: the referee between two fits."""
    import numpy as np
    from scipy.linalg import solve_discrete_lyapunov
    from scipy.signal import lfilter, lfiltic

    size = max(len(phi), len(theta) + 1)
    transition = np.eye(size, k=1)
    transition[: len(phi), 0] = phi
    entry = np.zeros(size)
    entry[0] = 1.0
    entry[1 : len(theta) + 1] = -np.asarray(theta)
    noise = np.outer(entry, entry)
    state, covariance = np.zeros(size), solve_discrete_lyapunov(transition, noise)
    errors, variances = [], []
    for value in record:
        variance = covariance[0, 0]
        if abs(variance - 1.0) < 1e-12 and len(errors) >= size:
            break
        error = value - state[0]
        gain = transition @ covariance[:, 0] / variance
        state = transition @ state + gain * error
        covariance = transition @ covariance @ transition.T + noise - variance * np.outer(gain, gain)
        errors.append(error)
        variances.append(variance)
    done = len(errors)
    if done < len(record):
        ar, ma = np.r_[1.0, -np.asarray(phi)], np.r_[1.0, -np.asarray(theta)]
        past = lfiltic(ar, ma, errors[::-1][:size], record[:done][::-1][:size])
        rest = lfilter(ar, ma, record[done:], zi=past)[0]
        errors, variances = np.r_[errors, rest], np.r_[variances, np.ones(len(rest))]
    count = len(record)
    sigma2 = np.sum(np.square(errors) / variances) / count
    return -0.5 * (count * (math.log(2.0 * math.pi * sigma2) + 1.0) + np.sum(np.log(variances)))


def relative(ours, peer):
    return abs(ours - peer) / max(abs(peer), sys.float_info.min)


def check_arma(p, q):
    """Likelihoods alone are compared: where they are flat, so are the optima, and coefficients differ."""

    def check(ours, peer, record):
        mine, theirs = (log_likelihood(record, fit[:p], fit[p : p + q]) for fit in (ours, peer))
        print(f"  ours: phi {ours[:p]}, theta {ours[p : p + q]}, sigma {ours[-2]:.9f}")
        print(f"  peer: phi {peer[:p]}, theta {peer[p : p + q]}, sigma {peer[-2]:.9f}")
        print(f"  reported log-likelihood: ours {ours[-1]:.6f}, peer {peer[-1]:.6f}")
        print(f"  referee's at these:      ours {mine:.6f}, peer {theirs:.6f}")
        # The sums of both have a rounding error of 1e-16 of some 1e7, a step: far less than a difference
        # that matters (0.5 is one standard error of one coefficient).
        assert abs(mine - ours[-1]) < 1e-3, "our log-likelihood is not the exact one"
        assert mine >= theirs - 0.01, f"our fit is {theirs - mine:.2g} below the peer's"
        if mine - theirs > 0.01:
            return f"peer ends {mine - theirs:.2g} below in log L"
        return f"log L: ours {mine - theirs:+.1e}"

    return check


def check_pandit_wu(ours, peer, _):
    """Orders by F and by BIC, then the log-likelihood of every fit."""
    lines = []
    for order, mine, theirs in zip(PANDIT_WU, ours[4:], peer[4:]):
        print(f"  {order}: log-likelihood ours {mine:.4f}, peer {theirs:.4f}")
        # As for a single fit; a peer that ends lower may choose another order.
        assert mine >= theirs - 0.01, f"our fit of {order} is {theirs - mine:.2g} below the peer's"
        lines.append(mine - theirs)
    print(f"  orders by F and by BIC: ours {ours[:4]}, peer {peer[:4]}")
    if ours[:4] == peer[:4]:
        return f"same orders; log L up to {max(lines):.2g} above"
    assert max(lines) > 0.01, "the same fits lead to other orders"
    return f"peer's fits end up to {max(lines):.2g} below, other orders"


def check_allan(ours, peer, _):
    mine = {round(t * RATE_HZ): d for t, d in zip(ours[::2], ours[1::2])}
    theirs = {round(t * RATE_HZ): d for t, d in zip(peer[::2], peer[1::2])}
    print(f"  ours: {len(mine)} points, {list(mine.values())[:3]} ...")
    print(f"  peer: {len(theirs)} points, {list(theirs.values())[:3]} ...")
    missing = sorted(set(theirs) - set(mine))
    assert not missing, f"averaging factors {missing[:5]} are missing in ours"
    worst = max(relative(mine[m], theirs[m]) for m in theirs)
    # The peer sums the record without taking out its mean: digits lost with the phase's size, some 1e-16
    # times 1e4 to 1e5. Ours at all τ is by FFT where its bound is 5e-10.
    allowed = 1e-10 if len(theirs) < 100 else 6e-10
    assert worst < allowed, f"deviations differ by {worst:.1e}"
    return f"{len(theirs)} points, {worst:.0e}"


def check_correlations(ours, peer, _):
    worst = max(abs(a - b) for a, b in zip(ours, peer))
    print(f"  ours: {ours[:4]} ...\n  peer: {peer[:4]} ...")
    # The peer's are by FFT: rounding of 1e-16 times the logarithm of the length, and of the mean's removal.
    assert len(ours) == len(peer) and worst < 1e-10, f"correlations differ by {worst:.1e}"
    return f"{len(peer)} lags, {worst:.0e}"


def check_values(ours, peer, _):
    """The statistic and what follows p, relative; p, absolute: the peers interpolate tables."""
    ours = ours[: len(peer)]
    print(f"  ours: {ours}\n  peer: {peer}")
    worst = max(relative(a, b) for a, b in zip(ours[:1] + ours[2:], peer[:1] + peer[2:]))
    # Sums of 2 million terms and the solution of a least-squares problem of condition 1e4.
    assert worst < 1e-8, f"statistics differ by {worst:.1e}"
    assert abs(ours[1] - peer[1]) < 1e-6, "p-values differ"
    return f"{worst:.0e}"
