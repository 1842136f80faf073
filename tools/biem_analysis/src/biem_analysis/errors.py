"""The one exception of the package."""


class BiemAnalysisError(RuntimeError):
    """Input that cannot be analysed; the text says what was found and what to do.

    It is not an OSError: MDAnalysis takes an OSError from a reader for the end of the trajectory.
    """
