"""The intermediate representation, its passes, its interpreter and its cost model."""
