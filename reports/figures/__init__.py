"""The figures of the report, one module a subject: functions of data that draw with matplotlib."""
