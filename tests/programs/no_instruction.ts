!!TS1.0
// nothing
