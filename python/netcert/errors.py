"""Exceptions. Their words are those of the program: they name the file, field or id, and the way out."""


class NetcertError(Exception):
    """What netcert refuses. Files raise `OSError`; options that do not exist or are out of range raise `ValueError` or `TypeError`."""


class VehicleError(NetcertError, ValueError):
    """A vehicle's definition cannot be used. The message lists every fault."""


class UnknownVehicle(VehicleError, KeyError):
    """A catalogue has no vehicle of this id. The message names similar ids."""

    # KeyError would put quotes around its message.
    __str__ = Exception.__str__


class CorridorError(NetcertError, ValueError):
    """A corridor's points or widths cannot be used. The message names the field and index."""


class RegionError(NetcertError):
    """A database cannot be read: another program made it, it is damaged, or it lacks a table."""


class NotFound(RegionError, LookupError):
    """A database does not have what is asked for. The message says what would put it there."""


class PlaceError(NetcertError, ValueError):
    """A place of a route is too far from any road. The message names the nearest one."""
