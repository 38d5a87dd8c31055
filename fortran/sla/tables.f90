!> Tooth tables of a model, one behind the other.
module sla_tables
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use common_lists, only : law_yielding => sla_law_yielding
   use sla_sawtooth, only : make_teeth, softening, softening_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: tooth_tables, tooth_tables_new, tooth_tables_copy

   type :: tooth_tables
      integer, allocatable :: first(:)       !! (tables + 1) first tooth of each
      real(wp), allocatable :: modulus(:)    !! [Pa]
      real(wp), allocatable :: strength(:)   !! [Pa]
      real(wp), allocatable :: band(:)       !! (tables) crack band [m]
      type(softening), allocatable :: law(:) !! (tables) of the teeth; none of a yielding one
   contains
      procedure :: tables
      procedure :: modulus_of
      procedure :: strength_of
      procedure :: tooth_of
      procedure :: nearest_band
   end type tooth_tables

   integer, parameter :: most_teeth = 4096

contains

   !> Tables from rows of (kind, E, ft, Gf, h, p, exact, overshoot)
   subroutine tooth_tables_new(rows, teeth, bad, status)
      real(wp), intent(in) :: rows(:, :)        !! (8, tables)
      type(tooth_tables), intent(out) :: teeth
      integer(c_int), intent(out) :: bad        !! the row that failed, 1-based
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: modulus(:), strength(:), all_moduli(:), all_strengths(:), longer(:)
      integer(c_int) :: n
      integer :: k, used, info

      bad = 0
      status = status_ok
      allocate (teeth%first(size(rows, 2) + 1), teeth%band(size(rows, 2)), teeth%law(size(rows, 2)), &
         modulus(most_teeth), strength(most_teeth), &
         all_moduli(64 * (size(rows, 2) + 64)), all_strengths(64 * (size(rows, 2) + 64)), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      used = 0
      teeth%first(1) = 1
      teeth%band(:) = rows(5, :)
      do k = 1, size(rows, 2)
         call make_teeth(nint(rows(1, k), c_int), rows(2, k), rows(3, k), rows(4, k), rows(5, k), rows(6, k), &
            rows(7, k) > 0.5_wp, rows(8, k) > 0.5_wp, n, modulus, strength, status)
         if (status /= status_ok) then
            bad = int(k, c_int)
            return
         end if
         if (nint(rows(1, k), c_int) /= law_yielding) call softening_new(nint(rows(1, k), c_int), rows(2, k), &
            rows(3, k), rows(4, k), rows(5, k), teeth%law(k), status)
         if (used + n > size(all_moduli)) then
            allocate (longer(2 * size(all_moduli) + n), stat=info)
            if (info /= 0) exit
            longer(1:used) = all_moduli(1:used)
            call move_alloc(longer, all_moduli)
            allocate (longer(size(all_moduli)), stat=info)
            if (info /= 0) exit
            longer(1:used) = all_strengths(1:used)
            call move_alloc(longer, all_strengths)
         end if
         all_moduli(used + 1:used + n) = modulus(1:n)
         all_strengths(used + 1:used + n) = strength(1:n)
         used = used + n
         teeth%first(k + 1) = used + 1
      end do
      if (info == 0) allocate (teeth%modulus(used), teeth%strength(used), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      teeth%modulus(:) = all_moduli(1:used)
      teeth%strength(:) = all_strengths(1:used)
   end subroutine tooth_tables_new

   !> The tables again; an assignment would not tell where there is no memory for it
   subroutine tooth_tables_copy(teeth, copy, status)
      type(tooth_tables), intent(in) :: teeth
      type(tooth_tables), intent(out) :: copy
      integer(c_int), intent(out) :: status
      integer :: info
      status = status_ok
      if (.not. allocated(teeth%first)) return
      allocate (copy%first(size(teeth%first)), copy%modulus(size(teeth%modulus)), &
         copy%strength(size(teeth%strength)), copy%band(size(teeth%band)), copy%law(size(teeth%law)), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      copy%first(:) = teeth%first
      copy%modulus(:) = teeth%modulus
      copy%strength(:) = teeth%strength
      copy%band(:) = teeth%band
      copy%law(:) = teeth%law
   end subroutine tooth_tables_copy

   !> How many there are
   pure function tables(teeth) result(count)
      class(tooth_tables), intent(in) :: teeth
      integer :: count
      count = 0
      if (allocated(teeth%first)) count = size(teeth%first) - 1
   end function tables

   !> Secant modulus of a tooth; the floor after the last, the initial modulus without a table [Pa]
   pure function modulus_of(teeth, table, tooth, initial, floor) result(modulus)
      class(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: table     !! 0: none
      integer(c_int), intent(in) :: tooth     !! from 1
      real(wp), intent(in) :: initial         !! [Pa]
      real(wp), intent(in) :: floor           !! over the initial modulus
      real(wp) :: modulus
      modulus = initial
      if (table == 0 .or. tooth == 1) return
      if (teeth%first(table) + tooth - 1 < teeth%first(table + 1)) then
         modulus = teeth%modulus(teeth%first(table) + tooth - 1)
      else
         modulus = floor * initial
      end if
   end function modulus_of

   !> Strength of a tooth times `share`, huge after the last and without a table [Pa]
   pure function strength_of(teeth, table, tooth, share) result(strength)
      class(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: table
      integer(c_int), intent(in) :: tooth
      real(wp), intent(in) :: share
      real(wp) :: strength
      strength = huge(1.0_wp)
      if (table == 0) return
      if (teeth%first(table) + tooth - 1 < teeth%first(table + 1)) then
        strength = share * teeth%strength(teeth%first(table) + tooth - 1)
      end if
   end function strength_of

   !> The stiffest tooth of a table that is no stiffer than `modulus`, one after the last where there is none
   pure function tooth_of(teeth, table, modulus) result(tooth)
      class(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: table
      real(wp), intent(in) :: modulus         !! [Pa]
      integer(c_int) :: tooth
      do tooth = 1, int(teeth%first(table + 1) - teeth%first(table), c_int)
         if (teeth%modulus(teeth%first(table) + tooth - 1) <= modulus) return
      end do
   end function tooth_of

   !> Of the tables of one law for bands that grow from `first` to `last`, the one nearest to `band` by ratio
   pure function nearest_band(teeth, first, last, band) result(table)
      class(tooth_tables), intent(in) :: teeth
      integer(c_int), intent(in) :: first
      integer(c_int), intent(in) :: last
      real(wp), intent(in) :: band            !! [m]
      integer(c_int) :: table
      table = first
      do while (table < last)
         if (band**2 <= teeth%band(table) * teeth%band(table + 1)) exit
         table = table + 1_c_int
      end do
   end function nearest_band

end module sla_tables
