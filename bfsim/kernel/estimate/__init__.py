"""The estimate: what a C compiler would make of a kernel for the Blackfin, pass by pass, and what that costs."""
