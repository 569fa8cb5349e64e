int nothing_of_interest = 0;
