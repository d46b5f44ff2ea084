"""Fourier transforms of the search. Slow to import, and many a program only names parameters: searches import it."""

from scipy.fftpack import next_fast_len

try:
    from scipy.fft import irfft2, rfft2
except ImportError:  # SciPy before 1.4, as on Ubuntu 20.04: slower, and of double precision
    from numpy.fft import irfft2, rfft2

__all__ = ["irfft2", "next_fast_len", "rfft2"]
