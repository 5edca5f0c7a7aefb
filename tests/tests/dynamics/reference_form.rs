//! Theorems 2 and 3 on random trees of all types of the library.

hamel_tests::reference_form_tests!(hamel_tests::random::without_knots());
