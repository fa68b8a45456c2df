"""Robot files: from YAML text to frozen records, checked for form, nothing evaluated."""
