"""The exceptions of victorious: one tree, one class for each reason."""


class Error(Exception):
    """What went wrong, in one line: what, where, and what would be right. `code` names the reason."""

    code = ""


class InvalidArgument(Error, ValueError):
    """An unusable value, file or parameter: the caller must change it."""

    code = "invalid_argument"


class NotFound(Error):
    """The named item does not exist."""

    code = "not_found"


class AlreadyExists(Error):
    """The name is taken."""

    code = "already_exists"


class DataLoss(Error):
    """External data that is corrupt, truncated or of another program."""

    code = "data_loss"


class Unsupported(Error):
    """Well-formed, but of a kind or version that is not read."""

    code = "unsupported"


class PermissionDenied(Error):
    """A read-only folder or file."""

    code = "permission_denied"


class NoSpace(Error):
    """A full disk."""

    code = "no_space"


class Conflict(Error):
    """Another process does the same work: try again later."""

    code = "conflict"


class Cancelled(Error):
    """A callback ended the work."""

    code = "cancelled"


class Internal(Error):
    """A library or the system failed for a reason that the input does not explain."""

    code = "internal"


class Unavailable(Error):
    """What is needed, as a database, does not answer or is locked by others: try again later."""

    code = "unavailable"


CLASSES = (
    InvalidArgument, NotFound, AlreadyExists, DataLoss, Unsupported, PermissionDenied, NoSpace, Conflict, Cancelled,
    Internal, Unavailable,
)  # fmt: skip
BY_CODE = {one.code: one for one in CLASSES}
